"""The service on a real PostgreSQL server: one that is killed, goes away, is slow, or is shared."""

from __future__ import annotations

import json
import shutil
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import text

from hil.core.errors import BenchError
from hil.service.store import BenchStore, open_database
from tests.hil.service.postgresql import Cluster, cluster
from tests.hil.service.served import ASKING, SHORT, RefusedError, Served, served

BENCHES = Path(__file__).parents[3] / "benches"
LONG = SHORT.replace("name: short", "name: long").replace(
    "duration_s: 0.2}\n  - step", "duration_s: 40}\n  - step"
)


@pytest.fixture(scope="module")
def server() -> Iterator[Cluster]:
    """One that is ended and started by the tests."""
    with cluster() as one:
        yield one


@pytest.mark.hunt  # make service-stores kills it too
def test_a_killed_service_loses_nothing_and_runs_nothing_twice(server: Cluster, tmp_path: Path) -> None:
    data, state, url = tmp_path / "data", tmp_path / "state", server.database()
    with served(data, "--database", url, state=state) as service:
        cut, waiting = _asking(service), service.queue()
        _under_way(service, cut)
        service.process.kill()
        service.process.wait(10)
    with served(data, "--database", url, state=state) as service:
        over = service.over(cut)
        assert (over["state"], over["safe_state"]) == ("interrupted", "confirmed")
        assert service.over(waiting)["exit_code"] == 0
    assert server.sql(url, "SELECT count(*), count(DISTINCT id) FROM runs") == "2|2"
    assert server.sql(url, "SELECT count(*) FROM benches") == "0", "given back when it ended"


@pytest.mark.slow
def test_a_run_goes_on_while_the_database_is_away_and_is_written_down_afterwards(
    server: Cluster, tmp_path: Path
) -> None:
    with served(tmp_path / "data", "--database", server.database(), state=tmp_path / "state") as service:
        service.give("short", SHORT)
        service.give("long", LONG)
        run, waiting = service.queue("long"), service.queue(key="once")
        _under_way(service, run)
        server.end()
        for ask in (
            lambda: service.get(f"/runs/{run}"),
            lambda: service.queue(),
            lambda: service.get("/health"),
        ):
            problem = _refused(ask)
            assert "the database cannot be reached since" in problem["what"]
        result = tmp_path / f"data/runs/{run:06d}/result.json"
        assert not result.exists()
        _until(result.exists)
        assert json.loads(result.read_text())["safe_state"] == "confirmed"
        time.sleep(1.0)
        server.begin()
        _until(lambda: _answers(service))
        over = service.over(run)
        assert (over["state"], over["exit_code"]) == ("ended", 0)
        assert service.over(waiting)["exit_code"] == 0
        assert service.queue(key="once") == waiting
        assert [one["id"] for one in service.get("/runs")] == [waiting, run]


@pytest.mark.slow
def test_an_emergency_stop_does_not_wait_for_a_database_that_hangs(server: Cluster, tmp_path: Path) -> None:
    with served(tmp_path / "data", "--database", server.database(), state=tmp_path / "state") as service:
        run = _asking(service)
        _under_way(service, run)
        with server.frozen():
            began_s = time.monotonic()
            assert service.post("/benches/sim/emergency-stop")["state"] == "emergency_stop"
            result = tmp_path / f"data/runs/{run:06d}/result.json"
            _until(result.exists)
            assert json.loads(result.read_text())["safe_state"] == "confirmed"
            assert time.monotonic() - began_s < 30.0
        _until(lambda: _answers(service))
        assert service.over(run)["exit_code"] == 3
        _until(lambda: "emergency stop" in {one["action"] for one in service.get("/audit")})


@pytest.mark.slow
def test_two_services_of_a_database_never_drive_one_bench(server: Cluster, tmp_path: Path) -> None:
    url, bench = server.database(), tmp_path / "other.toml"
    shutil.copytree(BENCHES, tmp_path, dirs_exist_ok=True)
    text = (BENCHES / "sim.toml").read_text()
    bench.write_text(text.replace('name = "sim"', 'name = "other"', 1).replace('"sim/', '"other/'))
    with served(tmp_path / "one", "--database", url, state=tmp_path / "state") as one:
        second = served(tmp_path / "two", "--database", url)
        with pytest.raises(AssertionError, match="the process has ended"), second:
            pass
        with served(tmp_path / "two", "--database", url, "--bench", str(bench)) as two:
            one.give("short", SHORT)
            two.give("short", SHORT)
            run = two.queue(bench="other")
            assert two.over(run)["exit_code"] == 0
            assert one.get(f"/runs/{run}")["bench"] == "other"
            with pytest.raises(RefusedError) as refused:
                one.post(f"/runs/{run}/pause")
            assert refused.value.status == 409
        engine = open_database(url)
        try:  # a third one that is started when the first was unheard of for long
            server.sql(url, "UPDATE benches SET until = now() - interval '1 s' WHERE bench = 'sim'")
            assert BenchStore(engine, "third", "elsewhere").hold("sim") == ""
        finally:
            engine.dispose()
        waits = one.queue()
        _until(lambda: one.get("/benches/sim")["state"] == "in_use")
        assert one.get("/benches/sim")["why"] == "elsewhere"
        assert one.get(f"/runs/{waits}")["state"] == "queued"


@pytest.mark.slow
def test_a_server_whose_certificate_is_not_right_is_refused_where_that_is_asked_for() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with cluster(port) as server:
        name = server.database().partition("@/")[2].partition("?")[0]
        roots = f"sslrootcert={server.certificate}"
        for host, asked in (
            ("localhost", f"verify-full&{roots}"),
            ("127.0.0.1", "require"),
            ("127.0.0.1", "prefer"),
        ):
            assert _over_tls(f"postgresql://hil@{host}:{port}/{name}?sslmode={asked}")
        assert not _over_tls(f"postgresql://hil@localhost:{port}/{name}?sslmode=disable")
        for host, asked in (("localhost", "verify-full"), ("127.0.0.1", f"verify-full&{roots}")):
            with pytest.raises(BenchError, match="CERTIFICATE_VERIFY_FAILED"):
                open_database(f"postgresql://hil@{host}:{port}/{name}?sslmode={asked}")


def _over_tls(url: str) -> bool:
    engine = open_database(url)
    try:
        with engine.connect() as connection:
            asked = text("SELECT ssl FROM pg_stat_ssl WHERE pid = pg_backend_pid()")
            return bool(connection.execute(asked).scalar())
    finally:
        engine.dispose()


def _asking(service: Served) -> int:
    service.give("asking", ASKING)
    service.give("short", SHORT)
    return service.queue("asking")


def _under_way(service: Served, run: int) -> None:
    service.until(run, lambda found: found["state"] == "running" and found["share"] is not None)


def _answers(service: Served) -> bool:
    try:
        return bool(service.get("/health")["status"] == "ok")
    except RefusedError as error:
        assert error.status == 503
        return False


def _refused(ask: Any) -> Any:
    with pytest.raises(RefusedError) as refused:
        ask()
    assert refused.value.status == 503
    return refused.value.problem


def _until(wanted: Any, within_s: float = 40.0) -> None:
    until_s = time.monotonic() + within_s
    while not wanted():
        assert time.monotonic() < until_s
        time.sleep(0.1)
