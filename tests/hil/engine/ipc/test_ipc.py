"""Between who asks for a run and who holds the hardware nothing passes but data: a pipe would do."""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, TypeVar

from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.engine import RunOutcome, RunRequest, run_plan
from hil.engine.ipc.ipc import Analysis, analysed_here
from test_plans import Conductor, Outlook, Pace, Plan, Step, Work
from tests.benches_for_tests import plan, sim_bench
from tests.operators import Answering

T = TypeVar("T")
STEPS = """
  - operator_prompt: {text: stand clear}
  - chirp: {segment: c, quantity: motor_torque, from_hz: 1, to_hz: 9, duration_s: 2, amplitude_nm: 10}
"""


class Look(Step):
    """Looks at the run so far."""

    kind: ClassVar[str] = "look"

    def execute(self, conductor: Conductor) -> None:
        conductor.analyse("look", self._work, ("samples.txt",))

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        return Outlook(0.0, speed_m_s)

    def _work(self, recording: Recording, made: Path) -> Mapping[str, bytes]:
        return {"samples.txt": str(len(recording.time_s)).encode()}


def across(thing: T) -> T:
    """What comes out at the other end of a pipe between two processes."""
    return pickle.loads(pickle.dumps(thing))  # type: ignore[no-any-return]


def run_on_the_other_side(asked: Plan, out: Path, heard: list[str]) -> RunOutcome:
    """A run of which nothing but bytes passes in either direction."""

    def analyse(work: Work, recording: Recording, directory: Path) -> Analysis:
        heard.append("analyse")
        return across(analysed_here(*across((work, recording, directory))))

    def progress(share: float, text: str) -> None:
        heard.append(f"progress {across((share, text))[1]}")

    request = RunRequest(
        plan=across(asked),
        bench=across(sim_bench("border")),
        out=across(out),
        terminal=Answering(then=lambda text: heard.append(across(text))),
        progress=progress,
        analyse=analyse,
    )
    return across(run_plan(request))


def test_a_run_with_prompts_and_analysis_needs_nothing_but_data(tmp_path: Path) -> None:
    heard: list[str] = []
    asked = plan(STEPS)
    asked = asked.model_copy(update={"steps": (*asked.steps, Look())})
    outcome = run_on_the_other_side(asked, tmp_path, heard)
    assert (outcome.error, outcome.result.safe_state, outcome.made) == (None, "confirmed", ("samples.txt",))
    assert int((tmp_path / "samples.txt").read_text()) > 2000
    assert {"analyse", "progress c"} <= set(heard)
    assert any(text.startswith("stand clear") for text in heard)


def test_an_error_passes_as_it_is(tmp_path: Path) -> None:
    steps = """
  - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 0.01, before_s: 0.2, after_s: 0.5}
  - identify: {use: [s]}
"""
    outcome = run_on_the_other_side(plan(steps), tmp_path, [])
    assert isinstance(outcome.error, BadInputError)
    assert outcome.error.what
    assert outcome.result.safe_state == "confirmed"
