from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from test_plans.metrics import (
    NoValueError,
    Overshoot,
    OvershootPercent,
    OvershootPercentShaftTorque,
    OvershootShaftTorque,
)
from tests.test_plans.signals import STEP, recording_of, second_order_step, time_axis


@given(st.floats(0.05, 0.8))
def test_overshoot_of_a_second_order_step(damping: float) -> None:
    time = time_axis()
    recording = recording_of(time, shaft_torque_nm=second_order_step(time, 326.0, damping, 2 * np.pi))
    expected = np.exp(-np.pi * damping / np.sqrt(1 - damping**2))
    assert OvershootShaftTorque().compute(recording, STEP) == pytest.approx(326 * expected, abs=0.01)
    assert OvershootPercentShaftTorque().compute(recording, STEP) == pytest.approx(100 * expected, abs=0.01)


def test_no_overshoot_is_zero() -> None:
    time = time_axis()
    recording = recording_of(time, shaft_torque_nm=np.full(len(time), 300.0))
    assert OvershootShaftTorque().compute(recording, STEP) == 0.0
    assert OvershootPercentShaftTorque().compute(recording, STEP) == 0.0


def test_reference_and_step_size_can_be_given() -> None:
    time = time_axis()
    recording = recording_of(time, motor_speed_rad_s=np.full(len(time), 12.0))
    assert Overshoot(channel="motor_speed_rad_s", reference=10.0).compute(recording, STEP) == 2.0
    percent = OvershootPercent(channel="motor_speed_rad_s", reference=10.0, step_size=8.0)
    assert percent.compute(recording, STEP) == 25.0
    assert (percent.unit, Overshoot(channel="motor_speed_rad_s").unit) == ("%", "rad/s")
    assert "Reference: 10 rad/s. In percent of 8." in percent.definition


def test_a_step_down_overshoots_downwards() -> None:
    time = time_axis()
    torque = np.where(time < STEP.step_s + 0.0005, 326.0, np.where(time < STEP.step_s + 0.1, -40.0, 5.0))
    recording = recording_of(time, shaft_torque_nm=torque)
    down = STEP.model_copy(update={"reference_before": 326.0, "reference_after": 0.0})
    assert OvershootShaftTorque().compute(recording, down) == 40.0
    assert OvershootPercentShaftTorque().compute(recording, down) == pytest.approx(100 * 40 / 326)


def test_no_step_has_none() -> None:
    time = time_axis()
    recording = recording_of(time, shaft_torque_nm=np.zeros(len(time)))
    level = STEP.model_copy(update={"reference_before": 326.0})
    with pytest.raises(NoValueError, match="no step"):
        OvershootPercentShaftTorque().compute(recording, level)
