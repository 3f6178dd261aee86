from __future__ import annotations

import numpy as np
import pytest

from test_plans.metrics import Peak, PeakShaftTorque
from tests.test_plans.signals import STEP, recording_of, second_order_step, time_axis


def test_peak_of_a_second_order_step() -> None:
    time = time_axis()
    torque = second_order_step(time, 326.0, 0.2, 2 * np.pi * 2)
    overshoot = np.exp(-np.pi * 0.2 / np.sqrt(1 - 0.2**2))
    recording = recording_of(time, shaft_torque_nm=torque)
    assert PeakShaftTorque().compute(recording, STEP) == pytest.approx(326 * (1 + overshoot), rel=1e-5)


def test_what_lies_before_the_step_and_outside_of_the_window_does_not_count() -> None:
    time = time_axis()
    values = np.select([time < 2.99, time > 13.001], [900.0, 800.0], 100.0)
    recording = recording_of(time, wheel_speed_rad_s=values)
    metric = Peak(channel="wheel_speed_rad_s", to_s=10.0)
    assert metric.compute(recording, STEP) == 100.0
    assert metric.unit == "rad/s"
    assert Peak(channel="wheel_speed_rad_s").compute(recording, STEP) == 800.0


def test_a_negative_peak_stays_negative() -> None:
    time = time_axis()
    recording = recording_of(time, shaft_torque_nm=np.full(len(time), -5.0))
    assert PeakShaftTorque().compute(recording, STEP) == -5.0
