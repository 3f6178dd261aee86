"""The service killed at random moments of a queue of runs: nothing is lost, nothing is started twice."""

from __future__ import annotations

import os
import random
import time
from pathlib import Path

import pytest

from tests.hil.service.left import was_safe_and_whole
from tests.hil.service.served import SHORT, Served, served

#: `make service-kills` tries fifty.
MOMENTS = int(os.environ.get("HIL_SERVICE_KILLS", "1"))
_LATEST_S = 8.0
_RUNS = 3


@pytest.mark.slow
@pytest.mark.parametrize("moment", range(MOMENTS))
def test_a_queue_survives_a_kill_at_any_moment(tmp_path: Path, moment: int) -> None:
    data, state = tmp_path / "data", tmp_path / "state"
    after_s = random.Random(moment).uniform(0.0, _LATEST_S)
    with served(data, state=state) as service:
        service.give("short", SHORT)
        runs = [service.queue() for _ in range(_RUNS)]
        time.sleep(after_s)
        service.process.kill()
        service.process.wait(10)
        started = sorted(path.name for path in (data / "runs").iterdir()) if (data / "runs").is_dir() else []
    with served(data, state=state) as service:
        ended = [service.over(run) for run in runs]
        assert [run["id"] for run in ended] == runs
        assert len(service.get("/runs")) == _RUNS
        assert {run["state"] for run in ended} <= {"ended", "interrupted"}
        cut = [run for run in ended if run["state"] == "interrupted"]
        assert len(cut) <= 1, "one bench executes one run"
        assert all(f"{run['id']:06d}" in started or not run["files"] for run in cut)
        for run in ended:
            _look_at(service, data, run["id"], run["state"])


def _look_at(service: Served, data: Path, run: int, state: str) -> None:
    """A run's data are kept, and its bench was safe."""
    folder = data / "runs" / f"{run:06d}"
    was_safe_and_whole(folder, state)
    assert service.get(f"/runs/{run}")["state"] == state
