"""A file says by which format it is to be read; one of a later version is refused in words."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.controller import controller_from_toml, controller_to_toml, load_controller
from hil.core.errors import BadInputError
from hil.core.files.toml_file import FORMAT
from hil.core.model import load_model, model_to_toml
from hil.engine import load_bench
from test_plans import load_plan, plan_from_text
from tests.benches_for_tests import SIM

CONTROLLER = Path("test_plans/library/controllers/phase_stabilization.toml")
NEWER = "is of a newer version of this software"


def test_files_that_are_written_say_their_format():
    assert model_to_toml(load_model(SIM.simulation.model)).startswith(f"format = {FORMAT}\n")
    assert controller_to_toml(load_controller(CONTROLLER)).startswith(f"format = {FORMAT}\n")


@pytest.mark.parametrize(
    ("number", "said"), [("2", NEWER), ("0", "must be 1"), ("true", "must be 1"), ('"1"', "must be 1")]
)
def test_another_format_is_refused_with_its_line(number, said, tmp_path):
    for name, read in (("bench", load_bench), ("model", load_model)):
        source = SIM.source if name == "bench" else SIM.simulation.model
        file = tmp_path / f"{name}.toml"
        file.write_text(f"format = {number}\n{source.read_text()}")
        with pytest.raises(BadInputError, match=said) as caught:
            read(file)
        assert "format" in str(caught.value)
    with pytest.raises(BadInputError, match=said):
        controller_from_toml(f"format = {number}\n{CONTROLLER.read_text()}", "a controller")
    plan = load_plan("acceptance")
    with pytest.raises(BadInputError, match=said):
        plan_from_text(f"format: {number}\n{plan.text}", "a plan", plan.source.parent)


def test_the_number_of_todays_format_may_be_said(tmp_path):
    plan = load_plan("acceptance")
    said = plan_from_text(f"format: 1\n{plan.text}", "a plan", plan.source.parent)
    assert said.segments == plan.segments
