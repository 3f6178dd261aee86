"""The example plans of the how-to are sound, fit the shipped bench, and should keep their own criteria."""

from __future__ import annotations

import re

import pytest

from hil.core.model import load_model
from hil.engine import load_bench
from hil.engine.prediction.prediction import predict
from test_plans import judge, plan_from_text
from tests.docs.documented import ROOT

PAGE = ROOT / "docs/how-to/own-plan.md"
PLANS = re.findall(r"```yaml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)


@pytest.mark.parametrize("text", PLANS, ids=range(len(PLANS)))
def test_it_passes(text: str) -> None:
    bench = load_bench("sim")
    assert bench.simulation is not None
    plan = plan_from_text(text, PAGE.name, PAGE.parent)
    predicted = predict(plan, bench, load_model(bench.simulation.model))
    judged = judge(plan, predicted.recording, predicted.segments)
    assert [criterion.id for criterion in judged if criterion.failed] == []
    assert any(criterion.verdict == "pass" for criterion in judged)
