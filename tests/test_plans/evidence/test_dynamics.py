"""Whether T_s comes when N T_m does, whatever the course of the torque, and moves a car."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter, lsim

from test_plans import Array
from test_plans.evidence._dynamics import inertia_in_words, lag_in_words
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
SHORT = STEP.model_copy(update={"end_s": STEP.step_s + 4.0})
NOISE = np.random.default_rng(8).normal(0.0, 0.7, len(TIME))


def axle_torque(motor: Array) -> Array:
    """T_s of an axle at 10.6 Hz with 4 % damping, 4 ms late, 0.97 of N T_m."""
    pole = 2 * np.pi * 10.6
    _, torque, _ = lsim(([pole**2], [1.0, 0.08 * pole, pole**2]), 8.148 * 0.97 * motor, TIME)
    return np.concatenate([np.zeros(4), torque[:-4]]) + NOISE


AFTER = np.maximum(TIME - STEP.step_s, 0.0)
COURSES = {
    "step": np.where(AFTER > 0, 25.0, 0.0),
    "slow": 25.0 * (1.0 - np.exp(-AFTER / 0.3)),
    "overshoot": np.where(AFTER > 0, 25.0 + 20.0 * np.exp(-AFTER / 0.1), 0.0),
    "down": np.where(AFTER > 0, -25.0, 25.0),
}


def said(motor: Array, shaft: Array) -> str:
    recording = recording_of(TIME, motor_torque_nm=motor, shaft_torque_nm=shaft)
    return lag_in_words(recording, SHORT).get("shaft_torque_nm", "")


@pytest.mark.parametrize("course", COURSES)
def test_an_axle_is_not_late(course: str) -> None:
    assert said(COURSES[course], axle_torque(COURSES[course])) == ""


def late(seconds: float) -> Callable[[Array], Array]:
    rows = round(1000 * seconds)
    return lambda torque: np.concatenate([np.full(rows, torque[0]), torque[:-rows]])


def low_passed(seconds: float) -> Callable[[Array], Array]:
    share = np.exp(-0.001 / seconds)
    return lambda torque: np.asarray(lfilter([1 - share], [1, -share], torque))


CHANGES = {
    "s after": late(0.3),
    "s after ": low_passed(0.15),
    "before": lambda torque: torque - 50.0 * AFTER,
    "after": lambda torque: np.repeat(torque[::400], 400)[: len(torque)],
}


@pytest.mark.parametrize("course", COURSES)
@pytest.mark.parametrize("change", CHANGES)
def test_a_sensor_that_is_late_or_drifts_is(change: str, course: str) -> None:
    told = said(COURSES[course], CHANGES[change](axle_torque(COURSES[course])))
    if change == "before" and course == "down":  # a drift against the step looks late
        change = "after"
    assert "shaft_torque_nm comes" in told
    assert change.strip() in told or change == "after"


def inertia_told(acceleration: Array, torque: Array) -> str:
    speed = 5.0 + np.cumsum(acceleration) * 0.001
    recording = recording_of(TIME, wheel_speed_rad_s=speed, shaft_torque_nm=torque)
    return inertia_in_words(recording, SHORT).get("wheel_speed_rad_s", "")


@pytest.mark.parametrize("inertia", [12.0, 65.0, 303.0, 2500.0])
@pytest.mark.parametrize("before", [0.0, -150.0, 400.0])
def test_a_car_accelerates_with_the_torque(inertia: float, before: float) -> None:
    torque = np.where(AFTER > 0, 200.0, before)
    assert inertia_told((torque - 40.0) / inertia, torque + NOISE) == ""


def test_what_no_car_does_is_told() -> None:
    torque = np.where(AFTER > 0, 200.0, 0.0)
    assert "makes -303 kg m²" in inertia_told(-torque / 303.0, torque)
    assert "makes inf kg m²" in inertia_told(0.0 * torque, torque)
    assert "makes 4 kg m²" in inertia_told(torque / 4.0, torque)
