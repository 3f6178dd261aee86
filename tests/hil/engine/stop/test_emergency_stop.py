"""An emergency stop outlives its process, whatever the bench file is called; hazardous plans want a name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from hil.core.errors import BadInputError, BenchError, EmergencyStopError
from hil.core.recording import read_recording
from hil.engine import RunRequest, run_plan
from hil.engine.stop.emergency_stop import latch, refuse_latched, reset
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from tests.benches_for_tests import SIM, plan, sim_bench
from tests.operators import Silent

WAIT = "[{wait: {duration_s: 0.2}}]"


@pytest.fixture(autouse=True)
def own_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HIL_STATE", str(tmp_path / "state"))
    return tmp_path / "state"


def test_it_stays_until_a_person_resets_it(tmp_path: Path) -> None:
    bench = sim_bench("kept")
    refuse_latched(bench)
    latch(bench, by="the operator", why="smoke", run=tmp_path)
    with pytest.raises(BenchError, match="by the operator: smoke") as caught:
        refuse_latched(bench)
    assert "its stop ends with the process" in caught.value.fix
    (stop,) = reset(bench, "A. Tester")
    assert (stop.why, stop.reset_by) == ("smoke", "A. Tester")
    refuse_latched(bench)
    assert reset(bench, "A. Tester") == []
    (kept,) = (tmp_path / "state").glob("*/emergency-stops/reset/*.json")
    assert "A. Tester" in kept.read_text()


def test_a_copy_of_the_bench_file_is_the_same_bench_and_another_bench_is_not(tmp_path: Path) -> None:
    bench = sim_bench("one")
    latch(bench, by="x", why="y", run=tmp_path)
    with pytest.raises(BenchError):
        refuse_latched(bench.model_copy(update={"name": "copy"}))
    refuse_latched(sim_bench("two"))


def test_one_that_cannot_be_latched_is_told(tmp_path: Path, own_state: Path) -> None:
    own_state.write_text("no folder")
    operator = Silent()
    request = RunRequest(plan(WAIT), sim_bench("unkept"), tmp_path / "out", terminal=operator)
    request.progress = lambda share, text: operator.waiting.append("e")
    outcome = run_plan(request)
    assert outcome.result.emergency_stop is not None
    assert not outcome.result.emergency_stop.latched
    assert "could NOT be latched" in str(outcome.error)


def emcy_at(share: float, name: str, codes: tuple[int, ...], tmp_path: Path) -> Any:
    dyno = SIM.dyno.model_copy(update={"emergency_stop_codes": codes})
    request = RunRequest(plan("[{wait: {duration_s: 2}}]"), sim_bench(name, dyno=dyno), tmp_path)
    request.progress = lambda done, text: attached(name).fail(Fault.DYNO_DEAF) if done > share else None
    return run_plan(request)


@pytest.mark.parametrize(("codes", "kind"), [((0x8130,), EmergencyStopError), ((0xFF01,), BenchError)])
def test_an_emcy_that_says_so_is_one(codes: tuple[int, ...], kind: Any, tmp_path: Path) -> None:
    outcome = emcy_at(0.2, f"emcy-{codes[0]}", codes, tmp_path)
    assert type(outcome.error) is kind
    assert "0x8130" in str(outcome.error)
    assert (outcome.result.emergency_stop is not None) == (kind is EmergencyStopError)


def test_one_in_the_end_steps_counts_more_than_what_ended_the_run(tmp_path: Path) -> None:
    operator = Silent()
    ended = plan("[{hold_speed: {speed_km_h: 5, duration_s: 5}}]", end="[{ramp_down: {duration_s: 3}}]")
    request = RunRequest(ended, sim_bench("late"), tmp_path, terminal=operator)
    typed = iter(["q", "e", ""])
    request.progress = lambda share, text: operator.waiting.append(next(typed, "")) if share > 0.2 else None
    outcome = run_plan(request)
    assert isinstance(outcome.error, EmergencyStopError)
    assert outcome.result.end_steps == "started, but not completed"
    with pytest.raises(BenchError, match="emergency stop since"):
        refuse_latched(sim_bench("late"))


@pytest.mark.parametrize("hazardous", [True, "the wheels turn at 300 km/h"])
def test_a_hazardous_plan_wants_a_name(hazardous: bool | str, tmp_path: Path) -> None:
    asked = plan(WAIT).model_copy(update={"hazardous": hazardous})
    with pytest.raises(BadInputError, match="the plan is hazardous") as caught:
        run_plan(RunRequest(asked, sim_bench("hazard"), tmp_path))
    assert "--confirm" in caught.value.fix
    assert list(tmp_path.iterdir()) == []
    outcome = run_plan(RunRequest(asked, sim_bench("hazard"), tmp_path, hazard_confirmed_by="A. Tester"))
    assert outcome.error is None
    run = read_recording(outcome.recording).metadata["run"]
    assert run["hazard_confirmed_by"] == "A. Tester"
