"""How a run ends whose service or agent was killed, or that meets what keeps it from beginning."""

from __future__ import annotations

import asyncio
import datetime
import os
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import pytest

from hil.api_schemas.agent import TakenRun
from hil.api_schemas.api import RunData
from hil.engine.bench.bench_lock import alone_on
from hil.execution.benches import Bench
from hil.execution.run_execution import RunEnd, RunExecution, end_of_left
from tests.hil.service.served import SHORT


def test_it_ended_when_something_was_last_written(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    for name, at_s in (("run.lock", 1000.0), ("recording.mcap", 5000.5), ("parts/log.txt", 4000.0)):
        path = tmp_path / name
        path.write_bytes(b"x")
        os.utime(path, (at_s, at_s))
    end = end_of_left(tmp_path, "service", None)
    assert end.state == "interrupted"
    assert end.reason == "the service ended during the run; data measured before that is kept"
    assert end.at == datetime.datetime.fromtimestamp(5000.5, datetime.UTC)


def test_of_one_that_left_nothing_no_moment_is_known(tmp_path: Path) -> None:
    end = end_of_left(tmp_path / "none", "agent", Bench("sim"))
    assert (end.at, end.result) == (None, None)
    assert end.dut == Bench("sim").dut != ""
    assert "before the recording started" in end.reason


def _end_of_one_that_meets(
    met: Callable[[Bench], AbstractContextManager[object]],
    folder: Path,
    of: str = "sim",
    early: Callable[[RunExecution], None] = lambda run: None,
) -> RunEnd:
    """Of a run that is executed while something stands in its way that was not there when it was taken."""
    data = RunData.model_validate(
        {
            "id": 1, "plan": "short", "title": "", "bench": "sim", "state": "running", "values": {},
            "priority": 0, "requested_by": "me", "queued_at": "2026-01-01T00:00:00Z",
        }
    )  # fmt: skip
    taken = TakenRun(
        data=data, plan_text=SHORT, plan_source="short.yaml", confirmed_by="", accept_expired="", files={}
    )
    bench = Bench(of, folder / "stops")

    async def ended() -> RunEnd:
        run = await RunExecution.begin(taken, bench, folder / "run")
        early(run)
        return await run.ended(bench, lambda: None, lambda: False)

    with met(bench):
        return asyncio.run(ended())


@pytest.mark.slow
def test_a_run_that_meets_a_stop_latched_meanwhile_is_over(tmp_path: Path) -> None:
    def stop(bench: Bench) -> AbstractContextManager[object]:
        bench.stop("anna", tmp_path)  # after the bench was looked at, before the run's process does
        return nullcontext()

    end = _end_of_one_that_meets(stop, tmp_path)
    assert (end.state, end.result) == ("ended", None)
    assert end.reason.startswith("stopped before it began: emergency stop since")
    assert "by anna" in end.reason


@pytest.mark.slow
def test_a_run_that_meets_another_program_waits_again(tmp_path: Path) -> None:
    end = _end_of_one_that_meets(lambda bench: alone_on(bench.file), tmp_path, of="rear_axle_socketcan")
    assert end.state == "queued"


@pytest.mark.slow
def test_what_is_asked_before_the_process_is_there_is_not_lost(tmp_path: Path) -> None:
    end = _end_of_one_that_meets(lambda bench: nullcontext(), tmp_path, early=lambda run: run.process.end())
    assert end.state == "ended"
    assert "stopped by the operator" in (end.reason or (end.result.reason if end.result else ""))
