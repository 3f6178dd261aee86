"""Which criteria hang on a controller."""

from pathlib import Path

import pytest

from hil.analysis.tuning import driven_by
from hil.core.errors import BadInputError
from test_plans import load_plan, plan_from_text
from test_plans.loading import LIBRARY
from tests.hil.analysis.tuning.trials import PLAN, STEP


def test_the_last_controller_is_tuned_and_what_is_compared_with_it_counts():
    driven = driven_by(load_plan("acceptance"))
    assert driven.file.stem == "phase_stabilization"
    assert driven.segments == ("phase_0kmh", "phase_20kmh")
    assert len(driven.criteria) == 10
    assert all(criterion.metric.name != "settling_shaft_torque" for criterion in driven.criteria)


def test_another_one_by_name():
    driven = driven_by(load_plan("acceptance"), "gain_stabilization")
    assert driven.segments == ("gain_0kmh", "gain_20kmh")
    assert "phase_0kmh.peak_shaft_torque.below.gain_0kmh" in [c.id for c in driven.criteria]
    with pytest.raises(BadInputError, match="did you mean 'gain_stabilization'"):
        driven_by(load_plan("acceptance"), "gain_stabilisation")


def test_a_plan_and_its_controller_beside_it_may_be_named_from_where_one_stands(tmp_path, monkeypatch):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/mine.toml").write_text((LIBRARY / "controllers/gain_stabilization.toml").read_text())
    (tmp_path / "mine/plan.yaml").write_text(PLAN.replace("phase_stabilization.toml", "mine.toml"))
    monkeypatch.chdir(tmp_path)
    driven = driven_by(load_plan("mine/plan.yaml"))
    assert driven.file == tmp_path / "mine/mine.toml"


LIMITS = "criteria:\n  - {segment: phase, metric: peak_shaft_torque"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (PLAN.replace("driving_torque", "motor_torque").partition("criteria")[0], "no criterion depends"),
        (PLAN.partition("criteria")[0], "no criterion with a limit depends"),
        (
            PLAN.partition("criteria")[0]
            + f"{LIMITS}, upper: 300}}\n{LIMITS.partition(chr(10))[2]}, lower: 310, id: b}}\n",
            "contradict each other",
        ),
        (
            f"name: n\nsteps:\n  - step: {{segment: s, {STEP.replace('driving', 'motor')}}}\n",
            "no criterion depends",
        ),
    ],
)
def test_a_plan_without_anything_to_tune_for_is_refused(text, said):
    with pytest.raises(BadInputError, match=said):
        driven_by(plan_from_text(text, "p.yaml", Path()))
