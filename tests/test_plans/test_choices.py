"""What a person chooses for one run stands in the plan's text afterwards."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from test_plans import Choices, Plan, controller_choices, load_plan
from test_plans.loading import LIBRARY
from test_plans.steps import SetController

GAIN, PHASE = (LIBRARY / "controllers" / f"{name}_stabilization.toml" for name in ("gain", "phase"))
ONE = """
name: one
steps:  # größer
  - set_controller: {file: phase_stabilization.toml}  # the lead
  - repeat:
      times: 2
      steps:
        - set_controller: {file: "phase_stabilization.toml"}
        - wait: {duration_s: 1}
"""


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    return Path(shutil.copy(GAIN, tmp_path / "mine=2.toml"))


def loaded(plan: Plan) -> list[Path | None]:
    return [step.file for step in plan.steps if isinstance(step, SetController)]


def test_the_only_controller_is_replaced_wherever_it_is_loaded(tmp_path, mine):
    file = tmp_path / "one.yaml"
    file.write_text(ONE, "utf-8")
    plan = load_plan(file, Choices(controller_choices([str(mine)], "--controller")))
    assert loaded(plan) == [mine]
    expected = ONE.replace('"phase_stabilization.toml"', "phase_stabilization.toml")
    assert plan.text == expected.replace("phase_stabilization.toml", f'"{mine}"')


def test_of_several_the_named_one_is_replaced(mine):
    chosen = controller_choices([f"gain_stabilization.toml={mine}"], "--controller")
    assert loaded(load_plan("acceptance", Choices(chosen))) == [mine, PHASE, mine, PHASE]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("{mine}", "loads 2 controllers: gain_stabilization.toml, phase_stabilization.toml"),
        ("gain.toml={mine}", "loads no controller 'gain.toml'"),
        ("no.toml", "there is no file 'no.toml'"),
        ("gain_stabilization.toml=", "there is no file ''"),
    ],
)
def test_what_fits_nothing_is_refused(given, message, mine):
    with pytest.raises(BadInputError, match=message):
        load_plan("acceptance", Choices(controller_choices([given.format(mine=mine)], "--controller")))


def test_a_plan_without_controller_takes_none(mine):
    with pytest.raises(BadInputError, match="loads no controller file"):
        load_plan("identification", Choices({"": mine}))
