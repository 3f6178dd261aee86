"""A service that was started since hears how fast the motor of a stopped bench turns."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

from tests.hil.cli.test_sim_bench import serving
from tests.hil.service.served import Served, served

pytestmark = pytest.mark.slow


def stopped(service: Served, bench: str) -> Any:
    """A bench after an emergency stop, as soon as something is known of its speed, at most a minute later."""
    service.post(f"/benches/{bench}/emergency-stop")
    for _ in range(600):
        found = service.get(f"/benches/{bench}")
        if found["last_speed"] or found["speed_unknown"]:
            break
        time.sleep(0.1)
    return found


def test_the_speed_of_a_stopped_bench_is_heard_without_a_run(tmp_path: Path) -> None:
    with serving(tmp_path) as (_, file), served(tmp_path / "data", "--bench", str(file)) as service:
        (bench,) = [one["name"] for one in service.get("/benches")]
        assert service.get(f"/benches/{bench}")["last_speed"] is None  # nothing is asked of a free bench
        found = stopped(service, bench)
        assert found["last_speed"]["turns"] is False
        assert abs(found["last_speed"]["speed_rad_s"]) < 0.5
        service.post(f"/benches/{bench}/reset")
        assert service.get(f"/benches/{bench}")["last_speed"] is None


def test_of_a_simulated_bench_it_says_why_not(tmp_path: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        assert (
            stopped(service, "sim")["speed_unknown"] == "the bench is simulated, and exists during a run only"
        )
