"""Wheel slip: the wheel's circumferential speed less the vehicle's, of the mean and of a side."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from test_plans.metrics import NoValueError, WheelSlip
from tests.test_plans.signals import STEP, recording_of, time_axis

TIME = time_axis()
SEGMENT = STEP.model_copy(update={"rolling_radius_m": 0.3})
LATE = np.clip((TIME - STEP.step_s) / 10.0, 0.0, 1.0)
ROAD = recording_of(
    TIME,
    vehicle_speed_m_s=3.0 + LATE,
    wheel_speed_rad_s=10.0 + 5.0 * LATE,
    wheel_speed_left_rad_s=10.0 + 10.0 * LATE,
    wheel_speed_right_rad_s=10.0 + 0.0 * LATE,
)


@pytest.mark.parametrize(
    ("channel", "wanted"),
    [("wheel_speed_rad_s", 0.5), ("wheel_speed_left_rad_s", 2.0), ("wheel_speed_right_rad_s", 1.0)],
)
def test_the_largest_difference_either_way(channel: str, wanted: float) -> None:
    assert WheelSlip(channel=channel).compute(ROAD, SEGMENT) == pytest.approx(wanted)


def test_the_window_counts() -> None:
    assert WheelSlip(to_s=5.0).compute(ROAD, SEGMENT) == pytest.approx(0.25, abs=1e-3)


def test_a_radius_is_needed_and_a_wheel() -> None:
    with pytest.raises(NoValueError, match="no radius"):
        WheelSlip().compute(ROAD, STEP)
    with pytest.raises(ValidationError, match="a wheel slips"):
        WheelSlip(channel="shaft_torque_nm")
