"""What is said of a run whose service or agent was killed."""

from __future__ import annotations

import asyncio
import datetime
import os
from pathlib import Path

import pytest

from hil.api_schemas.agent import TakenRun
from hil.api_schemas.api import RunData
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


@pytest.mark.slow
def test_a_run_that_meets_a_stop_latched_meanwhile_waits_again(tmp_path: Path) -> None:
    data = RunData.model_validate(
        {
            "id": 1, "plan": "short", "title": "", "bench": "sim", "state": "running", "values": {},
            "priority": 0, "requested_by": "me", "queued_at": "2026-01-01T00:00:00Z",
        }
    )  # fmt: skip
    taken = TakenRun(
        data=data, plan_text=SHORT, plan_source="short.yaml", confirmed_by="", accept_expired="", files={}
    )
    bench = Bench("sim", tmp_path / "stops")

    async def ended() -> RunEnd:
        bench.stop("anna", tmp_path)  # after the bench was looked at, before the run's process does
        run = await RunExecution.begin(taken, bench, tmp_path / "run")
        return await run.ended(bench, lambda: None, lambda: False)

    end = asyncio.run(ended())
    assert end.state == "queued"
    assert "emergency stop since" in end.reason
