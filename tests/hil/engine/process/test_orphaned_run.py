"""What is made of a recording whose process was lost: never more than it holds."""

from __future__ import annotations

from pathlib import Path

from hil.core.errors import BenchError
from hil.core.recording import read_recording
from hil.engine import RECORDING, RunRequest, run_plan
from hil.engine.process.lost_process import identity_of, recording_left, result_left
from tests.benches_for_tests import plan, sim_bench

STEPS = "[{step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 5, before_s: 0.2, after_s: 1.5}}]"
CRITERIA = "[{segment: s, metric: peak, channel: motor_torque_ref_nm, upper: 30, unit: N m}]"
LOST = BenchError("was ended by SIGKILL; safe: confirmed", where="the process")


def ran(folder: Path) -> RunRequest:
    request = RunRequest(plan(STEPS, CRITERIA), sim_bench("left-behind"), folder)
    assert run_plan(request).error is None
    return request


def test_a_recording_that_was_cut_off_is_an_error_whatever_its_criteria_say(tmp_path: Path) -> None:
    request = ran(tmp_path)
    path = tmp_path / RECORDING
    path.write_bytes(path.read_bytes()[: -path.stat().st_size // 3])
    recording = recording_left(path, None)
    assert recording is not None
    result = result_left(recording, request, "confirmed", LOST)
    assert (result.verdict, result.safe_state, result.reason) == ("error", "confirmed", str(LOST))
    assert (result.plan, result.bench) == (request.plan.name, request.bench.name)
    assert {criterion.verdict for criterion in result.criteria} <= {"pass", "not_judged"}


def test_also_one_that_is_whole_is_an_error(tmp_path: Path) -> None:
    request = ran(tmp_path)
    result = result_left(read_recording(tmp_path / RECORDING), request, "not_confirmed", LOST)
    assert (result.verdict, result.safe_state) == ("error", "not_confirmed")
    assert {criterion.verdict for criterion in result.criteria} == {"pass"}


def test_one_that_says_nonsense_of_its_run_is_no_reason_to_say_nothing(tmp_path: Path) -> None:
    request = ran(tmp_path)
    recording = read_recording(tmp_path / RECORDING)
    recording.attachments["run.json"] = b"{}"
    assert result_left(recording, request, "confirmed", LOST).verdict == "error"


def test_an_earlier_recording_is_not_taken_for_this_runs(tmp_path: Path) -> None:
    path = tmp_path / RECORDING
    assert recording_left(path, None) is None
    path.write_text("earlier")
    assert recording_left(path, identity_of(path)) is None
    assert recording_left(path, None) is None  # no recording at all
