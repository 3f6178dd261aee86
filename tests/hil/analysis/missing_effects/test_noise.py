"""Noise that a channel's readings prove."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._noise import colour_of, proven_noise, white_level
from hil.analysis.missing_effects._series import series_of
from hil.analysis.missing_effects._spectrum import powers_of
from hil.core.channels import INPUT, MOTOR_ANGLE, TIME
from hil.core.recording import Recording
from hil.plant import rounding_step
from tests.hil.analysis.missing_effects.turning_mass import base, recording

SPEED = "motor_speed_rad_s"


def test_white_noise_is_read_from_the_top_of_the_spectrum() -> None:
    series = series_of(base(0.54), [recording(0.54, 2.17, noise_rad_s=0.05)])
    level = proven_noise(series, {})
    assert level[0] == pytest.approx(0.05 / 2.0, rel=0.1)  # means of four samples
    assert np.isnan(level[1:]).all()


@pytest.mark.parametrize("count", [300, 1_000, 2_000, 20_000])
def test_white_noise_of_a_short_recording_is_no_smaller(count: int) -> None:
    levels = [white_level(np.random.default_rng(seed).normal(0.0, 0.3, count)) for seed in range(40)]
    assert np.mean(levels) == pytest.approx(0.3, rel=0.03)


def test_stated_noise_counts_where_it_is_larger() -> None:
    series = series_of(base(0.54), [recording(0.54, 2.17, noise_rad_s=0.05)])
    assert proven_noise(series, {SPEED: 0.4})[0] == pytest.approx(0.2)


@pytest.mark.parametrize("step", [0.63, 0.01])
def test_readings_on_a_grid_have_its_step(step: float) -> None:
    values = 20.0 * np.sin(np.linspace(0.0, 60.0, 40_000))
    assert rounding_step(np.round(values / step) * step) == pytest.approx(step, rel=1e-6)


def test_a_continuum_of_readings_has_no_step() -> None:
    assert rounding_step(np.random.default_rng(0).normal(size=10_000)) == 0.0


def _still(noise_rad: float, step_rad: float = 0.0) -> Recording:
    """An angle that drifts slowly, read with white noise and on a grid."""
    time = np.arange(60_000, dtype=np.float64) * 1e-3
    angle = 0.3 * time + np.random.default_rng(0).normal(0.0, max(noise_rad, 1e-12), len(time))
    if step_rad:
        angle = np.round(angle / step_rad) * step_rad
    return Recording({TIME: time, INPUT: np.sin(time), MOTOR_ANGLE: angle}, Path("still.csv"))


def test_noise_of_an_angle_is_that_of_what_it_turns_by_in_size_and_colour() -> None:
    series = series_of(base(0.54), [_still(2e-3)])
    error = series[0].measured - np.array([0.3, 0.0, 0.0])
    level, colour = proven_noise(series, {})[0], colour_of(series)
    assert level == pytest.approx(np.std(error[:, 0]), rel=0.03)
    shown = powers_of([error], series[0].rate_hz, np.ones(3)).power.mean(axis=0)[0] / level**2
    assert colour is not None
    assert shown[3:] == pytest.approx(colour[0, 3:], rel=0.15)
    assert colour[0, 0] < 1e-3 < colour[0, -1]  # it does not walk off
    assert colour[1:] == pytest.approx(1.0)


def test_an_encoders_steps_are_noise_of_its_angle() -> None:
    series = series_of(base(0.54), [_still(0.0, 1e-3)])
    by_steps = 1e-3 / np.sqrt(12.0) * np.sqrt(0.5) / 1e-3 / 4.0
    assert proven_noise(series, {})[0] == pytest.approx(by_steps, rel=0.05)
    assert proven_noise(series, {MOTOR_ANGLE: 5e-3})[0] > 10.0 * by_steps


def test_noise_of_speeds_has_no_colour() -> None:
    assert colour_of(series_of(base(0.54), [recording(0.54, 2.17, noise_rad_s=0.05)])) is None
