"""An agent, or its service, killed at random moments of a queue: nothing is lost, nothing starts twice."""

from __future__ import annotations

import os
import random
import time
from pathlib import Path

import pytest

from tests.hil.service.left import was_safe_and_whole
from tests.hil.service.served import SHORT, Served, served
from tests.hil.service.working import bench_called, working

#: `make agent-kills` tries fifty.
MOMENTS = int(os.environ.get("HIL_AGENT_KILLS", "1"))
_RUNS = 3
_LATEST_S = 14.0  # after the first was queued: the last is over by then


@pytest.mark.slow
@pytest.mark.parametrize("moment", range(MOMENTS))
def test_a_queue_survives_the_kill_of_its_agent_or_its_service(tmp_path: Path, moment: int) -> None:
    data, state, kept = tmp_path / "data", tmp_path / "state", tmp_path / "agent"
    far = bench_called("far", tmp_path / "benches")
    after_s, kills_agent = random.Random(moment).uniform(0.0, _LATEST_S), moment % 2 == 0
    with served(data, state=state) as service:
        service.give("short", SHORT)
        port = service.url.rpartition(":")[2]
        with working(service.url, kept, far, state=tmp_path / "far") as agent:
            runs = [service.queue(bench="far") for _ in range(_RUNS)]
            time.sleep(after_s)
            if kills_agent:
                agent.kill()
                with working(service.url, kept, far, state=tmp_path / "far"):
                    _look_at(service, kept, runs, most_cut=1)
                return
            service.process.kill()
            service.process.wait(10)
            with served(data, "--port", port, state=state) as again:
                _look_at(again, kept, runs, most_cut=0)


def _look_at(service: Served, kept: Path, runs: list[int], most_cut: int) -> None:
    ended = [service.over(run) for run in runs]
    assert [one["id"] for one in service.get("/runs")] == runs[::-1]
    cut = [run for run in ended if run["state"] != "ended"]
    assert len(cut) <= most_cut, "one bench executes one run, and a service's end is not an agent's"
    assert {run["state"] for run in cut} <= {"interrupted"}
    assert not list((kept / "runs").glob("*.before-*")), "each was started once"
    for run in ended:
        _look_at_files(service.data, kept, run["id"], run["state"])


def _look_at_files(data: Path, kept: Path, run: int, state: str) -> None:
    """A run's data are kept on both sides, and its bench was safe."""
    there, here = kept / "runs" / f"{run:06d}", data / "runs" / f"{run:06d}"
    names = {path.name for path in there.glob("[!.]*") if path.name != "run.lock"}
    for name in names:
        assert (here / name).read_bytes() == (there / name).read_bytes(), name
    was_safe_and_whole(here, state)
