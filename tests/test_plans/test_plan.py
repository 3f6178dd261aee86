from __future__ import annotations

import pytest
from pydantic import ValidationError

from test_plans import Pace, estimate_duration_s, load_plan
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
