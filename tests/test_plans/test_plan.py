from __future__ import annotations

import pytest
from pydantic import ValidationError

from test_plans import Pace, estimate_duration_s, largest_requests_nm, load_plan
from tests.test_plans.writing import STEP, plan_of


def test_a_plan_cannot_be_changed() -> None:
    plan = plan_of({"wait": {"duration_s": 1}})
    with pytest.raises(ValidationError):
        plan.name = "other"  # type: ignore[misc]


def test_estimate_adds_up_ramps_steps_and_end_steps() -> None:
    plan = plan_of(
        {"hold_speed": {"speed_km_h": 36, "duration_s": 2}},
        {"step": STEP | {"load": "speed"}},
        {"repeat": {"times": 3, "steps": [{"wait": {"duration_s": 1}}, {"coast": {"duration_s": 0.5}}]}},
        {"operator_prompt": {"text": "Look"}},
        **{"finally": [{"ramp_down": {"duration_s": 4}}]},
    )
    assert estimate_duration_s(plan, Pace(speed_ramp_m_s2=5.0)) == pytest.approx(2 + 2 + 21 + 4.5 + 4)


def test_estimate_knows_that_a_released_vehicle_gains_speed() -> None:
    hold = {"hold_speed": {"speed_km_h": 0, "duration_s": 0}}
    pace = Pace(speed_ramp_m_s2=1.0)
    gained = pace.acceleration_m_s2("driving_torque", 326) * 20
    assert estimate_duration_s(plan_of({"step": STEP}, hold), pace) == pytest.approx(21 + gained)
    assert estimate_duration_s(plan_of({"step": STEP | {"load": "speed"}}, hold), pace) == pytest.approx(21)


def test_segments_of_the_whole_plan() -> None:
    assert [segment.id for segment in load_plan("identification").segments] == [
        "chirp_high",
        "chirp_low",
        "chirp_biased",
    ]


def test_the_largest_torque_that_a_plan_asks_for_is_that_of_its_steps_by_quantity() -> None:
    step = {"quantity": "driving_torque", "before_s": 0.5, "after_s": 1}
    down = {**step, "segment": "a", "from_nm": 0, "to_nm": -326}
    within = {**step, "segment": "b", "from_nm": 10, "to_nm": 200}
    sine = {
        "segment": "c",
        "quantity": "motor_torque",
        "from_hz": 1,
        "to_hz": 20,
        "amplitude_nm": 8,
        "bias_nm": 5,
    }
    plan = plan_of(
        {"step": down},
        {"repeat": {"times": 2, "steps": [{"step": within}]}},
        {"chirp": {**sine, "duration_s": 5}},
    )
    found = largest_requests_nm(plan)
    assert found["driving_torque"] == 326.0
    assert found["motor_torque"] == pytest.approx(5 + 8, rel=1e-3)
    assert largest_requests_nm(plan_of({"wait": {"duration_s": 1}})) == {}
