"""Recordings made ready: blocks, angles, and from which octave on a periodic torque says anything."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._series import Series, series_of
from hil.core.channels import INPUT, TIME
from hil.core.model import Model
from hil.core.recording import Recording

_MASS = Model(
    "rigid",
    {
        "motor_inertia": 0.3,
        "gear_ratio": 1.0,
        "vehicle_inertia": 0.2,
        "viscous_drag": 0.5,
        "torque_delay": 0.0,
    },
)


def _series(torque: np.ndarray) -> Series:
    time = np.arange(0.0, len(torque)) * 1e-3
    speed = np.cumsum(torque) * 1e-3 / 0.5
    recording = Recording({TIME: time, INPUT: torque, "motor_speed_rad_s": speed}, Path("one.csv"))
    return series_of(_MASS, [recording])[0]


def _multisine(seconds: int) -> np.ndarray:
    """Lines from 11 to 60 Hz that repeat every second, measured with a little noise."""
    rng = np.random.default_rng(0)
    time = np.arange(1000 * seconds) * 1e-3
    lines = [np.sin(2.0 * np.pi * hz * time + rng.uniform(0.0, 6.3)) for hz in range(11, 60, 2)]
    return np.asarray(np.sum(lines, axis=0) + 0.14 + rng.normal(0.0, 0.05, len(time)))


def test_below_the_lines_of_a_multisine_nothing_counts() -> None:
    assert _series(_multisine(12)).lowest_hz == pytest.approx(8.0)


def test_of_a_torque_that_does_not_repeat_all_octaves_count() -> None:
    steps = np.repeat(np.random.default_rng(1).normal(0.0, 5.0, 12), 1000)
    assert _series(steps).lowest_hz == 0.0


def test_a_torque_that_repeats_from_the_lowest_octave_on_counts_whole() -> None:
    square = np.tile(np.repeat([5.0, -5.0], 2000), 4)
    assert _series(square).lowest_hz == 0.0
