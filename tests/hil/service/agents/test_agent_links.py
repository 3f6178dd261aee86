"""An agent on a network that damages what it carries and lets connections go; and what it keeps meanwhile."""

from __future__ import annotations

import asyncio
import contextlib
import datetime
import http.client
import itertools
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from hil.agent._kept_runs import KeptRuns
from hil.agent._service import AwayError, TheService
from hil.api_schemas.agent import RunEnding, TakenRun
from hil.api_schemas.api import RunData
from hil.client import RefusedError
from tests.hil.service.served import SHORT, Served
from tests.hil.service.working import bench_called, working

_DAMAGED = 5  # first pieces of files
_EVERY = 7  # connection is let go, before it is asked or before it answers


@contextlib.contextmanager
def _bad_network(url: str) -> Iterator[tuple[str, list[str]]]:
    """A way to the service, and what it did to what passed."""
    where, did, count = urlsplit(url), list[str](), itertools.count(1)

    class Passing(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def log_message(self, *arguments: object) -> None:
            del arguments

        def do_GET(self) -> None:
            body = self.rfile.read(int(self.headers.get("content-length") or 0))
            number = next(count)
            if "/files/" in self.path and body and did.count("damaged") < _DAMAGED:
                did.append("damaged")
                body = bytes([body[0] ^ 0x40]) + body[1:]
            self.close_connection = True
            if number % (2 * _EVERY) == 0:
                did.append("let go")
                return
            service = http.client.HTTPConnection(where.hostname or "", where.port, timeout=30)
            headers = {name: value for name, value in self.headers.items() if name.lower() != "host"}
            service.request(self.command, self.path, body, headers)
            answer = service.getresponse()
            content = answer.read()
            service.close()
            if number % (2 * _EVERY) == _EVERY:
                did.append("let go")
                return
            self.send_response(answer.status)
            self.send_header("content-type", answer.headers.get_content_type())
            self.send_header("content-length", str(len(content)))
            self.send_header("connection", "close")
            self.end_headers()
            self.wfile.write(content)

        do_PUT = do_POST = do_DELETE = do_GET

    server = ThreadingHTTPServer(("127.0.0.1", 0), Passing)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}", did
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.mark.slow
def test_what_comes_damaged_or_not_at_all_comes_again_until_it_is_right(
    service: Served, tmp_path: Path
) -> None:
    bench = bench_called("shaky", tmp_path / "benches")
    with (
        _bad_network(service.url) as (url, did),
        working(url, tmp_path / "agent", bench, state=tmp_path / "state") as agent,
    ):
        runs = [service.queue(bench="shaky") for _ in range(2)]
        for run in runs:
            over = service.over(run)
            assert (over["state"], over["verdict"]) == ("ended", "pass")
            for name in over["files"]:
                there = agent.folder_of(run) / name
                assert service.get(f"/runs/{run}/files/{name}") == there.read_bytes() or name[-5:] == ".json"
        assert did.count("damaged") == _DAMAGED
        assert "let go" in did
        assert not list(agent.data.glob("runs/*.before-*")), "none was started twice"


def _taken(run: int) -> TakenRun:
    moment = "2026-01-01T00:00:00Z"
    data = RunData.model_validate(
        {
            "id": run, "plan": "short", "title": "", "bench": "far", "state": "running", "values": {},
            "priority": 0, "requested_by": "me", "queued_at": moment,
        }
    )  # fmt: skip
    return TakenRun(
        data=data,
        plan_text=SHORT,
        plan_source="short.yaml",
        confirmed_by="",
        accept_expired="",
        files={"mine.toml": "x = 1"},
    )


def test_a_run_is_on_the_disk_before_it_is_begun_and_until_the_service_has_it(tmp_path: Path) -> None:
    runs = KeptRuns(tmp_path, 30.0)
    started = runs.begin(_taken(3))
    source = Path(started.taken.plan_source)
    assert (source.read_text(), (source.parent / "mine.toml").read_text()) == (SHORT, "x = 1")
    (after_a_kill,) = KeptRuns(tmp_path, 30.0).pending()
    assert (after_a_kill.id, after_a_kill.ending, after_a_kill.taken) == (3, None, started.taken)
    (started.folder / "result.json").write_text("{}")
    started.end(RunEnding(state="ended", exit_code=0))
    (ended,) = KeptRuns(tmp_path, 30.0).pending()
    told = ended.ending_with(ended.files())
    assert (told.state, told.exit_code, [made.name for made in told.files]) == ("ended", 0, ["result.json"])
    ended.over()
    assert list(KeptRuns(tmp_path, 30.0).pending()) == []
    runs.clear()
    assert (started.folder / "result.json").exists(), "for 30 days"
    KeptRuns(tmp_path, 0.0).clear()
    assert not started.folder.exists()


def test_a_run_that_ended_with_its_agent_is_reported_with_the_moment_of_its_end(tmp_path: Path) -> None:
    left = KeptRuns(tmp_path, 30.0).begin(_taken(3))
    left.end(RunEnding(state="interrupted"), datetime.datetime(2020, 1, 1, tzinfo=datetime.UTC))
    (found,) = KeptRuns(tmp_path, 30.0).pending()
    assert found.ending_with([]).ago_s > 5 * 365 * 24 * 3600.0


def test_a_run_that_the_service_will_not_have_stays_and_one_of_its_number_takes_another_place(
    tmp_path: Path,
) -> None:
    runs = KeptRuns(tmp_path, 0.0)
    first = runs.begin(_taken(3))
    (first.folder / "recording.mcap").write_bytes(b"measured")
    first.end(RunEnding(state="ended"))
    first.over("it is none of this agent")
    runs.clear()
    again = runs.begin(_taken(3))
    assert not (again.folder / "recording.mcap").exists()
    (kept,) = tmp_path.glob("000003.before-*")
    assert (kept / "recording.mcap").read_bytes() == b"measured"
    assert [run.id for run in runs.pending()] == [3]
    third = runs.begin(_taken(3))
    assert [run.folder for run in runs.pending()] == [third.folder], "what was put aside is no one's work"


def test_the_next_service_is_asked_when_one_does_not_answer(service: Served) -> None:
    asked = TheService(["http://127.0.0.1:9", service.url], "")

    async def twice() -> str:
        with pytest.raises(AwayError, match="cannot be reached"):
            await asked.ask(lambda client: client.health())
        assert asked.away
        return (await asked.ask(lambda client: client.health())).status

    assert asyncio.run(twice()) == "ok"
    assert (asked.url, asked.away) == (service.url, "")
    with pytest.raises(RefusedError, match="there is no run"):
        asyncio.run(asked.ask(lambda client: client.run(99_999)))
