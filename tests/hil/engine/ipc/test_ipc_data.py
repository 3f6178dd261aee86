"""A request and an outcome are the same on both sides of the pipe."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.core.result import RunResult
from hil.engine import RunOutcome, RunRequest, load_bench
from hil.engine.ipc.ipc_data import asked_of, ended_of, outcome_of, request_of
from hil.engine.ipc.ipc_messages import RunAsked, from_line, to_line
from test_plans import Choices, load_plan
from tests.benches_for_tests import SIM, plan
from tests.operators import Silent


def across(request: RunRequest) -> RunRequest:
    asked = from_line(to_line(asked_of(request)))
    assert isinstance(asked, RunAsked)
    return request_of(asked)


@pytest.mark.parametrize("name", ["acceptance", "commissioning", "driveability", "identification", "slip"])
@pytest.mark.parametrize("bench", ["sim", "rear_axle_socketcan"])
def test_a_request_passes_as_it_is(name: str, bench: str):
    request = RunRequest(
        load_plan(name), load_bench(bench), Path("out"), model=load_model(SIM.simulation.model),
        operator="A", confirmed_by="B", hazard_confirmed_by="C", accept_expired="D: E", replaces=(Path("f"),),
    )  # fmt: skip
    passed = across(request)
    assert (passed.plan, passed.bench, passed.model) == (request.plan, request.bench, request.model)
    assert (passed.out, passed.replaces) == (request.out, request.replaces)
    assert (passed.operator, passed.confirmed_by) == ("A", "B")
    assert (passed.hazard_confirmed_by, passed.accept_expired) == ("C", "D: E")


def test_whether_somebody_can_be_asked_passes():
    request = RunRequest(plan("[{wait: {duration_s: 1}}]"), SIM, Path("out"))
    assert not asked_of(request).operator_is_there
    request.terminal = Silent()
    assert asked_of(request).operator_is_there


def test_a_file_that_has_gone_meanwhile_is_refused(tmp_path: Path):
    file = tmp_path / "p.yaml"
    own = tmp_path / "own.toml"
    own.write_bytes(
        (Path(__file__).parents[4] / "test_plans/library/controllers/gain_stabilization.toml").read_bytes()
    )
    file.write_text("name: p\nsteps: [{set_controller: {file: own.toml}}]\n")
    asked = asked_of(RunRequest(load_plan(file), SIM, tmp_path))
    assert request_of(asked).plan.steps
    own.unlink()
    with pytest.raises(BadInputError, match="own.toml"):
        request_of(asked)


def test_an_outcome_passes_as_it_is():
    result = RunResult(
        verdict="error",
        plan="p",
        bench="b",
        real_time_factor=1.0,
        bench_time_s=2.0,
        safe_state="not_confirmed",
    )
    outcome = RunOutcome(result, Path("r.mcap"), BenchError("x", where="y", fix="z"), {"a": 1.0}, ("f",))
    passed = outcome_of(ended_of(outcome))
    assert str(passed.error) == str(outcome.error)
    assert (passed.result, passed.recording, passed.largest, passed.made) == (
        result, outcome.recording, outcome.largest, outcome.made,
    )  # fmt: skip


def test_what_was_chosen_of_a_plan_passes(tmp_path: Path):
    file = tmp_path / "p.yaml"
    file.write_text(
        "name: p\nvariables: {wait: {default: 1, unit: s}}\nsteps: [{wait: {duration_s: $wait}}]\n"
    )
    request = RunRequest(load_plan(file, Choices(values={"wait": 2.0})), SIM, tmp_path)
    assert across(request).plan == request.plan
    assert across(request).plan.values[0].value == 2
