"""A segment ends where it was stopped, and nothing is made up of what came after."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from hil.core.result import Segment
from hil.engine import RunOutcome, RunRequest, run_plan
from hil.engine.run.preflight import preflight
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from tests.benches_for_tests import SIM, plan, sim_bench
from tests.operators import Answering

pytestmark = pytest.mark.usefixtures("heard_hangups")

STEPS = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 0.2}
  - step: {segment: first, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.2, after_s: 1}
  - hold_speed: {speed_km_h: 10, duration_s: 0.2}
  - step: {segment: second, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.2, after_s: 6}
"""
PEAKS = """
  - {segment: first, metric: peak_shaft_torque, upper: 400, unit: N m}
  - {segment: second, metric: peak, channel: shaft_torque_nm, to_s: 0.1, upper: 400, unit: N m}
"""


def stopped_in_second(tmp_path: Path, name: str, stop: str) -> RunOutcome:
    """Stops the run a while after its second segment began, long before that segment's end."""
    request = RunRequest(plan(STEPS, PEAKS), sim_bench(name), tmp_path)
    seen: list[str] = []

    def hook(share: float, text: str) -> None:
        seen.append(text)
        if seen.count("second") < 4:
            return
        if stop == "signal":
            signal.raise_signal(signal.SIGTERM)
        elif stop == "sighup":
            signal.raise_signal(signal.SIGHUP)
        elif stop == "fault":
            attached(name).fail(Fault.DYNO_DEAF)
        else:
            request.stop.ask()

    request.progress = hook
    return run_plan(request)


@pytest.mark.parametrize("stop", ["signal", "sighup", "fault", "ask"])
def test_its_end_is_the_real_one_and_its_criteria_are_not_judged(stop: str, tmp_path: Path) -> None:
    outcome = stopped_in_second(tmp_path, f"cut-{stop}", stop)
    first, second = outcome.result.segments
    assert (first.complete, second.complete) == (True, False)
    assert 1.0 < second.end_s - second.start_s < 4.0  # planned: 6.2 s
    recording = read_recording(outcome.recording, allow_missing=True)
    held = recording.between(second.step_s + 0.01, second.end_s - 0.02)
    assert np.all(held["driving_torque_ref_nm"] == 200.0)
    asked = [c for c in outcome.result.criteria if c.source == "plan"]
    assert {c.verdict for c in outcome.result.criteria if c.id.startswith("second.")} == {"not_judged"}
    assert {c.id: c.verdict for c in asked} == {
        "first.peak_shaft_torque": "pass",
        "second.peak": "not_judged",
    }
    assert "was stopped after" in outcome.result.criteria[1].reason
    assert outcome.result.verdict == "error"


def test_the_recording_alone_tells_it_too(tmp_path: Path) -> None:
    outcome = stopped_in_second(tmp_path, "told", "ask")
    metadata = read_recording(outcome.recording).metadata
    stored = [
        Segment.model_validate_json(metadata[f"segment/{name}"]["json"]) for name in ("first", "second")
    ]
    assert stored == list(outcome.result.segments)
    assert (
        json.loads(read_recording(outcome.recording).attachments["run.json"])["segments"][1]["complete"]
        is False
    )


def test_an_rmcu_in_fault_ends_its_segment(tmp_path: Path) -> None:
    name = "faulted"
    request = RunRequest(plan(STEPS, PEAKS), sim_bench(name), tmp_path)
    seen: list[str] = []

    def hook(share: float, text: str) -> None:
        seen.append(text)
        if seen.count("second") == 2:
            attached(name).fail(Fault.RMCU_DEAF)  # its requests time out: it gives no torque any more

    request.progress = hook
    outcome = run_plan(request)
    assert outcome.result.segments[1].complete is False
    assert outcome.result.criteria[1].verdict == "not_judged"
    assert "fault" in str(outcome.error)


def test_a_stop_that_was_asked_before_the_run_moves_nothing(tmp_path: Path) -> None:
    request = RunRequest(plan(STEPS, PEAKS), sim_bench("early"), tmp_path)
    request.stop.ask()
    outcome = run_plan(request)
    assert (outcome.result.safe_state, outcome.result.segments) == ("not_needed", ())
    assert {c.verdict for c in outcome.result.criteria} == {"not_judged"}


PROMPT = "[{operator_prompt: {text: 'Is the cage shut?'}}, {wait: {duration_s: 0.1}}]"


def test_a_prompt_is_answered_by_the_operator_or_by_name(tmp_path: Path) -> None:
    operator = Answering()
    outcome = run_plan(RunRequest(plan(PROMPT), sim_bench("p1"), tmp_path / "a", terminal=operator))
    assert outcome.error is None
    (told,) = operator.told
    assert told.startswith("Is the cage shut?")
    named = RunRequest(plan(PROMPT), sim_bench("p2"), tmp_path / "b", confirmed_by="A. Tester")
    recording = read_recording(run_plan(named).recording)
    assert recording.metadata["run"]["prompts_confirmed_by"] == "A. Tester"
    assert "confirmed in advance by A. Tester" in [e.text for e in recording.events if e.kind == "prompt"]


def test_on_hardware_a_prompt_that_nobody_can_answer_is_refused(tmp_path: Path) -> None:
    hardware = SIM.model_copy(update={"simulation": None})
    with pytest.raises(BadInputError, match=r"Is the cage shut\?.*no terminal"):
        preflight(plan(PROMPT), hardware, tmp_path, somebody_answers=False)
    preflight(plan(PROMPT), hardware, tmp_path)
    preflight(plan(PROMPT), SIM, tmp_path, somebody_answers=False)
