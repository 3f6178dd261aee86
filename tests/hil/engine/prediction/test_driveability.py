"""A reversal of torque through play is judged as a driver judges it, in both directions."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from hil.core.model import EffectUse, Model
from hil.core.result import CriterionResult
from hil.engine.prediction.prediction import predict
from test_plans import judge, plan_from_text
from test_plans.loading import LIBRARY
from tests.benches_for_tests import SIM
from tests.hil.analysis.tuning.trials import MODEL

PLAY = MODEL.with_effects(*MODEL.effects, EffectUse("backlash", {"half_gap_rad": 0.02}))


def judged(segment: str, model: Model) -> dict[str, CriterionResult]:
    """One segment of the shipped plan with its criteria, by metric."""
    document = yaml.safe_load((LIBRARY / "driveability.yaml").read_text("utf-8"))
    speed = int(segment.rsplit("_", 1)[1])
    steps = [
        {"set_controller": {"file": "phase_stabilization.toml"}},
        {"hold_speed": {"speed_km_h": speed, "duration_s": 1}},
        *(step for step in document["steps"] if next(iter(step.values())).get("segment") == segment),
    ]
    criteria = [one for one in document["criteria"] if one["segment"] == segment]
    text = yaml.safe_dump(
        {"name": "p", "steps": steps, "finally": [{"ramp_down": {"duration_s": 1}}], "criteria": criteria}
    )
    plan = plan_from_text(text, "plan.yaml", Path())
    found = predict(plan, SIM, model)
    results = judge(plan, found.recording, found.segments, measured=False, device=False)
    return {one.id.removeprefix(f"{segment}."): one for one in results}


def test_a_reversal_through_play_fails_by_trough_and_clunk() -> None:
    """300, -150 and 300 N m at 30 km/h, ±0.02 rad of play and the shipped lead."""
    found = judged("change_of_mind_30", PLAY)
    failed = {name for name, one in found.items() if one.verdict == "fail"}
    assert {"trough", "clunk"} <= failed
    assert found["trough"].value is not None
    assert found["trough"].value < -165.0
    assert found["clunk"].value is not None
    assert found["clunk"].value > 2e4
    back_out = judged("back_out_30", PLAY)
    assert back_out["clunk"].verdict == "fail"
    assert all(one.value is not None for one in back_out.values())


@pytest.mark.parametrize("segment", ["back_out_30", "regen_to_drive_30"])
def test_play_makes_more_of_each_of_its_own_figures(segment: str) -> None:
    without, within = judged(segment, MODEL), judged(segment, PLAY)
    for name in ("clunk", "time_in_play"):
        assert (without[name].value or 0.0) * 1.5 < (within[name].value or 0.0)
