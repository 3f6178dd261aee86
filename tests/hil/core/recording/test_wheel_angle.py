"""The wheel's angle since the recording's start, from its speed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.channels import WHEEL_ANGLE
from hil.core.recording import Recording
from hil.core.recording._table import with_wheel_angle


def test_the_angle_is_the_speeds_integral() -> None:
    time = np.concatenate([np.arange(0.0, 1.0, 0.01), np.arange(1.0, 3.0, 0.02)])
    recording = Recording({"time_s": time, "wheel_speed_rad_s": 2.0 * time - 1.0}, Path("made"))
    (whole,) = with_wheel_angle(recording, [(0.0, 3.0)])
    angle = whole[WHEEL_ANGLE]
    # the trapezoidal rule is exact for a speed that grows evenly
    assert angle == pytest.approx(time**2 - time)


def test_a_speed_that_is_not_known_turns_nothing() -> None:
    speed = np.array([np.nan, 2.0, 2.0, np.nan])
    recording = Recording({"time_s": np.arange(4.0), "wheel_speed_rad_s": speed}, Path("made"))
    (whole,) = with_wheel_angle(recording, [(0.0, 3.0)])
    assert whole[WHEEL_ANGLE] == pytest.approx([0.0, 1.0, 3.0, 4.0])


def test_a_stretch_knows_how_far_the_wheel_had_turned_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    time = np.round(np.arange(5000) * 1e-3, 9)
    speed = np.random.default_rng(0).standard_normal(5000)
    recording = Recording({"time_s": time, "wheel_speed_rad_s": speed}, Path("made"))
    (whole,) = with_wheel_angle(recording, [(0.0, 5.0)])
    monkeypatch.setattr("hil.core.recording._table.BLOCK", 700)
    late, early = with_wheel_angle(recording, [(3.0, 4.0), (0.7, 1.4)])
    assert np.array_equal(late[WHEEL_ANGLE], whole[WHEEL_ANGLE][3000:4001])
    assert np.array_equal(early[WHEEL_ANGLE], whole[WHEEL_ANGLE][700:1401])
