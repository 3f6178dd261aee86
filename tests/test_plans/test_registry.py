from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from test_plans import STEPS, plan_from_text, plan_schema
from tests.test_plans.note_taker import NoteTaker

PACKAGE = '''
from typing import ClassVar

from test_plans import Outlook, Step

class Honk(Step):
    """Sound the horn."""

    kind: ClassVar[str] = "honk"
    times: int

    def execute(self, conductor):
        conductor.prompt("honk " * self.times)

    def outlook(self, speed_m_s, pace):
        return Outlook(self.times, speed_m_s)
'''


@pytest.fixture
def horn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed package that offers steps."""
    (tmp_path / "horn.py").write_text(PACKAGE)
    installed = tmp_path / "horn-1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: horn\nVersion: 1.0\n")
    (installed / "entry_points.txt").write_text(
        "[hil.steps]\nhonk = horn:Honk\nlost = horn:Lost\nodd = json:dumps\nwait = horn:Honk\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.mark.usefixtures("horn")
def test_a_step_of_another_package() -> None:
    plan = plan_from_text("name: p\nsteps: [honk: {times: 2}]", "p.yaml", Path())
    conductor = NoteTaker()
    plan.steps[0].execute(conductor)
    assert conductor.calls == [("prompt", "honk honk ")]
    with pytest.raises(BadInputError, match="did you mean 'times'"):
        plan_from_text("name: p\nsteps: [honk: {tims: 2}]", "p.yaml", Path())


@pytest.mark.usefixtures("horn")
@pytest.mark.parametrize(
    ("kind", "says"), [("lost", "cannot be loaded: AttributeError"), ("odd", "is no step")]
)
def test_a_package_that_cannot_be_used_is_named(kind: str, says: str) -> None:
    with pytest.raises(BadInputError) as caught:
        plan_from_text(f"name: p\nsteps: [{kind}: {{}}]", "p.yaml", Path())
    assert says in str(caught.value)
    assert f"entry point '{kind}' of hil.steps" in str(caught.value)


@pytest.mark.usefixtures("horn")
def test_own_names_cannot_be_taken_over() -> None:
    assert STEPS.names().count("wait") == 1
    found = STEPS.find("wait")
    assert found is not None
    assert found.__module__ == "test_plans.steps.wait"


def test_unknown_names() -> None:
    assert STEPS.find("waits") is None
    assert "did you mean 'wait'" in STEPS.suggestion("waits")
    assert "honk" not in plan_schema()["$defs"]["step"]["properties"]
