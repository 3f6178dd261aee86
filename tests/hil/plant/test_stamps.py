"""Uneven time stamps: whose time readings keep, and what is held between them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from hil.core.recording import Recording
from hil.plant import at_true_times, even_times, held_over

CLOCK: npt.NDArray[np.float64] = np.arange(20_000, dtype=np.float64) * 1e-3
EVEN: npt.NDArray[np.float64] = np.arange(5, dtype=np.float64) * 0.01
JITTER = np.random.default_rng(0).uniform(-2e-4, 2e-4, len(CLOCK))
KEPT = np.delete(np.arange(len(CLOCK)), [4, 5, 9_000, 15_000])


def _recorded(speed: np.ndarray, time: np.ndarray) -> Recording:
    noise = np.random.default_rng(1).normal(0.0, 0.05, len(time))
    return Recording({"time_s": time, "motor_speed_rad_s": speed + noise}, Path("stamped.csv"))


def _speed(time: np.ndarray) -> np.ndarray:
    return np.asarray(30.0 * np.sin(2.0 * np.pi * 4.0 * time))


def test_readings_that_keep_a_clock_get_its_times():
    time = (CLOCK + JITTER)[KEPT]
    found = at_true_times(_recorded(_speed(CLOCK[KEPT]), time))
    assert found.time_s == pytest.approx(CLOCK[KEPT], abs=1e-5)


def test_readings_that_were_taken_when_they_say_keep_their_stamps():
    time = (CLOCK + JITTER)[KEPT]
    recording = _recorded(_speed(time), time)
    assert at_true_times(recording) is recording


def test_even_stamps_stay():
    recording = _recorded(_speed(CLOCK), CLOCK)
    assert at_true_times(recording) is recording


def test_times_over_stamps_that_jitter_or_lack_some_are_those_of_the_clock():
    grid, dt = even_times((CLOCK + JITTER)[KEPT])
    assert len(grid) == len(CLOCK)
    assert grid == pytest.approx(CLOCK, abs=1e-5)
    assert dt == pytest.approx(1e-3, rel=1e-6)


def test_steps_of_several_lengths_are_no_clock_and_the_grid_keeps_to_the_stamps():
    steps = np.random.default_rng(2).choice([2.7e-3, 1e-2], 3_000, p=[0.7, 0.3])
    time = np.cumsum(steps)
    grid, dt = even_times(time)
    assert (grid[0], grid[-1]) == pytest.approx((time[0], time[-1]))
    assert dt == pytest.approx(2.7e-3, rel=0.01)
    recording = _recorded(_speed(time), time)
    assert at_true_times(recording) is recording


def test_a_torque_held_between_uneven_stamps_keeps_its_impulse():
    stamps = np.array([0.0, 0.0103, 0.0198, 0.0301, 0.04])
    torque = np.array([1.0, 3.0, -2.0, 5.0, 7.0])
    mean = held_over(EVEN, 0.01, stamps, torque)
    assert mean == pytest.approx([1.0, 2.84, -2.0, 4.93, 7.0])
    assert np.sum(mean) * 0.01 == pytest.approx(np.sum(torque * np.diff([*stamps, 0.05])))
    assert held_over(EVEN, 0.01, EVEN, torque) == pytest.approx(torque)


def test_a_torque_goes_straight_over_samples_that_were_lost():
    mean = held_over(EVEN, 0.01, EVEN[[0, 1, 4]], np.array([1.0, 2.0, 5.0]))
    assert mean == pytest.approx([1.0, 2.0, 3.0, 4.0, 5.0])
