"""What the service knows of agents: whose a bench and a run are, and that files come as they were made."""

from __future__ import annotations

import asyncio
import datetime
import hashlib
import secrets
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import Engine, create_engine, text

from hil.api_schemas.agent import AgentBench, AgentReport, FileMade, RunEnding
from hil.core.errors import BadInputError, BenchError
from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.service.agents.agents import Agents
from hil.service.agents.remote_bench import AWAY_S
from hil.service.agents.run_upload import RunUploads
from hil.service.durations import Durations
from hil.service.store import (
    DurationStore,
    LeaseStore,
    NewRun,
    ReservationStore,
    RunStore,
    open_database,
)
from hil.service.turns import Turns
from test_plans import library_controllers
from tests.hil.service import served as served_by
from tests.hil.service.served import SHORT

ONE, OTHER = "1" * 32, "2" * 32


class _There:
    """A service's knowledge of agents, started again as often as wanted."""

    def __init__(self, folder: Path, engine: Engine) -> None:
        self.folder, self.engine = folder, engine
        self.runs, self.leases = RunStore(engine), LeaseStore(engine)
        self.reservations = ReservationStore(engine)
        self.agents = self.started()
        self.run_uploads = RunUploads("service", self.runs, folder)

    def started(self, service: str = "service") -> Agents:
        return Agents(
            self.engine,
            service,
            self.runs,
            Turns(self.runs, self.leases, self.reservations, Durations(DurationStore(self.engine))),
            self.folder,
            lambda plan: self.folder / f"{plan}.yaml",
            lambda bench: None,
        )

    def queue(self, plan: str = SHORT) -> int:
        source = self.folder / "short.yaml"
        new = NewRun("short", "", plan, str(source), "far", {}, "me")
        return self.runs.add(new, approved=True)[0].id

    def lapse(self) -> None:
        """Have it a minute later."""
        with self.engine.begin() as connection:
            long_ago = datetime.datetime(2020, 1, 1, tzinfo=datetime.UTC)
            connection.execute(text("UPDATE benches SET until = :then"), {"then": long_ago})
        for bench in self.agents.benches.values():
            bench.agent.heard_s -= 2 * AWAY_S
            bench.kept_s = -1e9


@pytest.fixture
def there(tmp_path: Path) -> Iterator[_There]:
    database = served_by.new_database() or f"sqlite:///{tmp_path / 'service.sqlite'}"
    engine = open_database(database)
    yield _There(tmp_path, engine)
    engine.dispose()


def _report(
    *,
    obeyed: list[str] | None = None,
    leaving: bool = False,
    running: int | None = None,
    bench: str = "far",
) -> AgentReport:
    told = AgentBench(name=bench, title="Far", simulated=True, limits={}, units={}, state="free")
    told.running = running
    if running is not None:
        told.state = "running"
    return AgentReport(
        name="cell 3", machine="box", version="1", benches=[told], obeyed=obeyed or [], leaving=leaving
    )


def test_a_run_is_given_to_its_agent_until_that_has_it_and_to_nobody_else(there: _There) -> None:
    assert there.agents.heard(ONE, _report()) == (["far"], {})
    run = there.queue()
    assert there.agents.orders(ONE, {}).waiting == ["far"]
    first, again = there.agents.take(ONE, "far"), there.agents.take(ONE, "far")
    assert first is not None
    assert first == again, "the answer may have gone astray"
    assert (first.data.id, first.plan_source) == (run, "short.yaml")
    there.agents.heard(ONE, _report(running=run))
    there.queue()
    assert there.agents.orders(ONE, {}).waiting == [], "one run per bench"
    assert there.agents.benches["far"].state() == ("running", "")


def test_what_a_plan_loads_goes_with_it_and_a_run_that_lacks_it_ends(there: _There) -> None:
    there.agents.heard(ONE, _report())
    plan = SHORT.replace("phase_stabilization", "mine")
    lacking = there.queue(plan)
    with pytest.raises(BadInputError, match=r"mine\.toml"):
        there.agents.take(ONE, "far")
    found = there.runs.get(lacking)
    assert found is not None
    assert (found.state, found.exit_code) == ("ended", 2)
    controller = library_controllers()["phase_stabilization"].read_text()
    (there.folder / "mine.toml").write_text(controller)
    there.queue(plan)
    taken = there.agents.take(ONE, "far")
    assert taken is not None
    assert taken.files == {"mine.toml": controller}


def test_a_name_is_one_agents_until_it_is_unheard_of_and_has_no_run(there: _There) -> None:
    there.agents.heard(ONE, _report())
    new, refused = there.agents.heard(OTHER, _report())
    assert (new, list(refused)) == ([], ["far"])
    assert "agent cell 3 on box" in refused["far"]
    run = there.queue()
    there.agents.take(ONE, "far")
    there.lapse()
    assert "unheard of since" in there.agents.heard(OTHER, _report())[1]["far"], "its run may be under way"
    there.runs.end(run, "ended")
    assert there.agents.heard(OTHER, _report()) == (["far"], {})
    assert list(there.agents.heard(ONE, _report())[1]) == ["far"], "now it is the other's"


def test_an_agent_that_is_away_keeps_its_run_also_for_the_next_service(there: _There) -> None:
    there.agents.heard(ONE, _report())
    run = there.queue()
    there.agents.take(ONE, "far")
    there.lapse()
    there.agents = there.started()
    bench = there.agents.benches["far"]
    state, why = bench.state()
    assert state == "away"
    assert f"run {run} ends there by itself" in why
    there.agents.heard(ONE, _report(running=run))
    assert bench.state()[0] == "running"


def test_another_service_of_the_database_takes_an_agents_bench_and_run_over(there: _There) -> None:
    there.agents.heard(ONE, _report())
    run = there.queue()
    there.agents.take(ONE, "far")
    second = there.started("another service")
    assert second.heard(ONE, _report(running=run)) == (["far"], {})
    running = second.benches["far"].running
    assert running is not None
    assert running.data.id == run
    assert [row.benches for row in there.started().all()] == []
    run_uploads = RunUploads("another service", there.runs, there.folder / "second")
    found = run_uploads.run_of(run, ONE)
    assert found is not None
    assert run_uploads.finish(found, ONE, RunEnding(state="ended", exit_code=0))
    there.lapse()
    there.agents.look()
    assert there.agents.benches["far"].running is None, "the first one sees that it is over"


def test_a_bench_that_was_let_go_is_anothers_and_its_run_comes_all_the_same(there: _There) -> None:
    there.agents.heard(ONE, _report())
    run = there.queue()
    there.agents.take(ONE, "far")
    there.lapse()
    there.agents.let_go("far", "anna")
    found = there.runs.get(run)
    assert found is not None
    assert found.state == "interrupted"
    assert "anna has let the bench" in found.reason
    assert there.agents.heard(OTHER, _report()) == (["far"], {})
    late = there.run_uploads.run_of(run, ONE)
    assert late is not None
    assert there.run_uploads.finish(late, ONE, RunEnding(state="ended", exit_code=1, ago_s=100.0))
    assert there.run_uploads.run_of(run, ONE) is None
    over = there.runs.get(run)
    assert over is not None
    assert (over.state, over.exit_code, over.reason) == ("ended", 1, "")
    assert over.ended_at is not None
    assert datetime.datetime.now(datetime.UTC) - over.ended_at > datetime.timedelta(seconds=99)


@pytest.mark.parametrize("agent", [ONE, OTHER])
def test_an_emergency_stop_of_a_bench_that_was_let_go_is_told_whoever_has_it_next(
    there: _There, agent: str
) -> None:
    there.agents.heard(ONE, _report())
    there.lapse()
    there.agents.stop_in_emergency("far", EmergencyAsked(by="anna"))
    there.agents.remember_stop("far", EmergencyAsked(by="anna"))
    there.agents.let_go("far", "anna")
    assert there.agents.benches["far"].state()[0] == "emergency_stop"
    there.agents = there.started()
    assert there.agents.heard(agent, _report())[1] == {}
    there.queue()
    orders = there.agents.orders(agent, {})
    assert ([one.kind for one in orders.orders], orders.waiting) == (["emergency_stop"], [])
    assert there.agents.take(agent, "far") is None
    there.agents.heard(agent, _report(obeyed=[orders.orders[0].id]))
    assert there.agents.benches["far"].state() == ("free", "")


def test_an_emergency_stop_is_told_until_the_agent_has_obeyed_also_by_the_next_service(
    there: _There,
) -> None:
    there.agents.heard(ONE, _report())
    there.agents.stop_in_emergency("far", EmergencyAsked(by="anna"))
    there.agents.remember_stop("far", EmergencyAsked(by="anna"))
    there.queue()
    assert there.agents.orders(ONE, {}).waiting == []
    there.lapse()
    there.agents = there.started()
    state, why = there.agents.benches["far"].state()
    assert state == "emergency_stop"
    assert "requested by anna; its agent has not confirmed it" in why
    there.agents.heard(ONE, _report())
    orders = there.agents.orders(ONE, {}).orders
    assert [(one.kind, one.by) for one in orders] == [("emergency_stop", "anna")]
    there.agents.heard(ONE, _report(obeyed=[one.id for one in orders]))
    assert there.agents.orders(ONE, {}).orders == []
    assert there.agents.benches["far"].state()[0] == "free", "what the agent says of its own latch counts"
    assert there.started().benches["far"].stop_by == ""


def test_what_makes_safer_is_told_late_and_what_lets_something_move_is_not(there: _There) -> None:
    there.agents.heard(ONE, _report())
    there.queue()
    there.agents.take(ONE, "far")
    running = there.agents.benches["far"].running
    assert running is not None
    process = running.process
    for ask in (process.pause, process.resume, process.end, lambda: process.answer("shut")):
        ask()
    assert len(there.agents.orders(ONE, {}).orders) == 4
    there.lapse()
    there.agents.heard(ONE, _report(running=running.data.id))
    assert [one.kind for one in there.agents.orders(ONE, {}).orders] == ["pause", "end"]
    there.lapse()
    assert not asyncio.run(there.agents.reset("far", "anna"))
    assert [one.kind for one in there.agents.orders(ONE, {}).orders] == ["pause", "end"]


def test_an_agent_that_leaves_is_away_at_once_and_its_name_is_free(there: _There) -> None:
    there.agents.heard(ONE, _report())
    there.agents.heard(ONE, _report(leaving=True))
    assert there.agents.benches["far"].state()[0] == "away"
    assert there.agents.heard(OTHER, _report()) == (["far"], {})


def _made(name: str, content: bytes) -> FileMade:
    return FileMade(name=name, size=len(content), sha256=hashlib.sha256(content).hexdigest())


def test_pieces_are_taken_where_the_file_ends_and_files_are_shown_when_they_are_whole(
    there: _There,
) -> None:
    there.agents.heard(ONE, _report())
    run = there.queue()
    there.agents.take(ONE, "far")
    content = secrets.token_bytes(1000)
    made = [_made("report.pdf", content), _made("empty.txt", b""), _made("plan.yaml", SHORT.encode())]
    run_uploads, folder = there.run_uploads, there.folder / f"{run:06d}"
    assert run_uploads.add(run, "report.pdf", 5, b"late") == 0
    assert run_uploads.add(run, "report.pdf", 0, content[:400]) == 400
    assert run_uploads.add(run, "report.pdf", 0, content[:400]) == 400, "sent twice"
    assert asyncio.run(run_uploads.missing(run, made)) == ["report.pdf"]
    assert not (folder / "report.pdf").exists()
    assert run_uploads.add(run, "report.pdf", 400, content[400:]) == 1000
    assert asyncio.run(run_uploads.missing(run, made)) == []
    found = run_uploads.run_of(run, ONE)
    assert found is not None
    assert run_uploads.run_of(run, OTHER) is None
    assert run_uploads.finish(found, ONE, RunEnding(state="ended", files=made))
    assert (folder / "report.pdf").read_bytes() == content
    assert run_uploads.are_those(run, made), "told a second time"
    assert not run_uploads.are_those(run, [_made("report.pdf", b"other")])


@given(st.lists(st.tuples(st.integers(0, 60), st.integers(0, 40)), max_size=30))
def test_whatever_pieces_come_in_whatever_order_the_file_is_what_it_begins_with(
    pieces: list[tuple[int, int]],
) -> None:
    content = bytes(range(60))
    with tempfile.TemporaryDirectory() as folder:
        run_uploads = RunUploads("service", RunStore(create_engine("sqlite://")), Path(folder))
        there = 0
        for at, size in pieces:
            before, there = there, run_uploads.add(1, "recording.mcap", at, content[at : at + size])
            assert there == (min(at + size, 60) if at == before else before)
        path = Path(folder) / "000001/recording.mcap"
        assert (path.read_bytes() if path.exists() else b"") == content[:there]


@pytest.mark.parametrize("name", ["recording.mcap", "report.pdf"])
@pytest.mark.parametrize("damage", ["flipped", "too long"])
def test_a_file_that_came_damaged_is_thrown_away_and_comes_again(
    there: _There, name: str, damage: str
) -> None:
    there.agents.heard(ONE, _report())
    run = there.queue()
    there.agents.take(ONE, "far")
    content = secrets.token_bytes(1000)
    wrong = bytes([content[0] ^ 1]) + content[1:] if damage == "flipped" else content + b"x"
    made = [_made(name, content)]
    assert there.run_uploads.add(run, name, 0, wrong) == len(wrong)
    assert asyncio.run(there.run_uploads.missing(run, made)) == [name]
    assert there.run_uploads.add(run, name, 0, content) == 1000
    assert asyncio.run(there.run_uploads.missing(run, made)) == []


def test_a_file_that_is_too_large_is_not_taken(there: _There, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hil.service.agents.run_upload.MOST_FILE_BYTES", 10)
    assert there.run_uploads.add(1, "log.txt", 0, b"0123456789") == 10
    with pytest.raises(BenchError, match="more than 10 bytes"):
        there.run_uploads.add(1, "log.txt", 10, b"0")
