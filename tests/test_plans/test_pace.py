from __future__ import annotations

import pytest

from test_plans import Pace


def test_ramps_take_time_in_both_directions() -> None:
    pace = Pace(speed_ramp_m_s2=2.0)
    assert pace.ramp_s(0.0, 10.0) == pace.ramp_s(10.0, 0.0) == 5.0


def test_torque_accelerates_through_gear_and_wheel() -> None:
    pace = Pace(gear_ratio=8.0, wheel_radius_m=0.5, load_inertia_kg_m2=100.0)
    assert pace.acceleration_m_s2("driving_torque", 200.0) == pytest.approx(1.0)
    assert pace.acceleration_m_s2("motor_torque", 25.0) == pytest.approx(1.0)
