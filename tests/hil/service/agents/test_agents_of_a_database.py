"""Agents where several services share a PostgreSQL server, and where that is away."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.hil.service.postgresql import Cluster, cluster
from tests.hil.service.served import ASKING, RefusedError, Served, served
from tests.hil.service.working import bench_called, working

pytestmark = pytest.mark.hunt  # make service-stores carries them out


@pytest.fixture(scope="module")
def server() -> Iterator[Cluster]:
    """One that is frozen by the tests."""
    with cluster() as one:
        yield one


def test_another_service_takes_a_lost_ones_bench_and_run_over(server: Cluster, tmp_path: Path) -> None:
    url, far = server.database(), bench_called("far", tmp_path / "benches")
    near = bench_called("near", tmp_path / "benches")
    other = ("--database", url, "--bench", str(near))
    with (
        served(tmp_path / "one", "--database", url, state=tmp_path / "state") as one,
        served(tmp_path / "two", *other, state=tmp_path / "state") as two,
        working(
            one.url, tmp_path / "agent", far, state=tmp_path / "far", arguments=("--server", two.url)
        ) as agent,
    ):
        one.give("asking", ASKING)
        run = one.queue("asking", bench="far")
        one.until(run, lambda found: "cage" in found["message"])
        one.process.kill()
        one.process.wait(10)
        two.until(run, lambda found: "cage" in found["message"])
        assert two.get("/benches/far")["running"] == run
        two.post(f"/runs/{run}/answer", {"text": "shut"})
        over = two.over(run)
        assert (over["state"], over["verdict"]) == ("ended", "pass")
        recording = two.get(f"/runs/{run}/files/recording.mcap")
        assert recording == (agent.folder_of(run) / "recording.mcap").read_bytes()


def test_an_emergency_stop_reaches_an_agent_while_the_database_hangs(server: Cluster, tmp_path: Path) -> None:
    far = bench_called("far", tmp_path / "benches")
    with (
        served(tmp_path / "data", "--database", server.database(), state=tmp_path / "state") as service,
        working(service.url, tmp_path / "agent", far, state=tmp_path / "far") as agent,
    ):
        service.give("asking", ASKING)
        run = service.queue("asking", bench="far")
        service.until(run, lambda found: "cage" in found["message"])
        with server.frozen():
            assert service.post("/benches/far/emergency-stop")["state"] == "emergency_stop"
            _until((agent.folder_of(run) / "result.json").exists)
        _until(lambda: _answers(service))
        over = service.over(run)
        assert (over["exit_code"], over["safe_state"]) == (3, "confirmed")
        _until(lambda: "emergency stop" in {one["action"] for one in service.get("/audit")})
        assert service.get("/benches/far")["state"] == "emergency_stop"


def _answers(service: Served) -> bool:
    try:
        return bool(service.get("/health")["status"] == "ok")
    except RefusedError as error:
        assert error.status == 503
        return False


def _until(wanted: Callable[[], bool], within_s: float = 40.0) -> None:
    until_s = time.monotonic() + within_s
    while not wanted():
        assert time.monotonic() < until_s
        time.sleep(0.1)
