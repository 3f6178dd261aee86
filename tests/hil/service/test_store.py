"""The store: what it hands out once, what it never forgets."""

from __future__ import annotations

import datetime
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import Engine, create_engine, text
from sqlalchemy.exc import DBAPIError

from hil.core.errors import BadInputError, BenchError
from hil.service.durations import Durations
from hil.service.store import (
    Base,
    BenchStore,
    DurationStore,
    LayoutStore,
    LeaseStore,
    LogStore,
    NewRun,
    ReservationStore,
    RunStore,
    TokenStore,
    open_database,
)
from hil.service.turns import Turns


def wanted(
    bench: str = "sim", *, by: str = "anna", priority: int = 0, hazard: str = "", key: str = ""
) -> NewRun:
    more = {"hazard": hazard, "key": key}
    return NewRun("p", "P", "name: p", "p.yaml", bench, {"x": 1.5}, by, priority=priority, **more)


def test_the_migrations_make_the_tables_that_the_code_has(engine: Engine) -> None:
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), Base.metadata) == []


def test_a_database_of_a_newer_version_is_refused(engine: Engine, url: str) -> None:
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(BadInputError, match="newer version"):
        open_database(url)


def test_a_database_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="cannot be used"):
        open_database(f"sqlite:///{tmp_path / 'none' / 'service.sqlite'}")


def test_a_key_is_a_persons_own_however_long_it_and_the_name_are(engine: Engine) -> None:
    runs = RunStore(engine)

    def added(by: str, key: str) -> int:
        return runs.add(wanted(by=by, key=key), approved=True)[0].id

    names = ("anna", "Anna von und zu Berg, night shift of test bench 4 " * 2)
    keys = ("once", *(f"{'k' * 90}{number}" for number in range(2)))
    first = {(by, key): added(by, key) for by in names for key in keys}
    assert len(set(first.values())) == 6
    assert {(by, key): added(by, key) for by, key in first} == first


def test_a_run_is_taken_once_and_ended_once(engine: Engine) -> None:
    runs = RunStore(engine)
    run, is_new = runs.add(wanted(), approved=True)
    assert (is_new, run.state, run.values) == (True, "queued", {"x": 1.5})
    assert runs.take(run.id, "me") is not None
    assert runs.take(run.id, "me") is None
    assert [one.id for one in runs.running("me")] == [run.id]
    assert runs.end(run.id, "ended", exit_code=0)
    assert not runs.end(run.id, "interrupted")
    assert runs.get(run.id).state == "ended"
    assert not runs.cancel(run.id, "too late")


def test_a_hazardous_run_waits_for_approval(engine: Engine) -> None:
    runs = RunStore(engine)
    run, _ = runs.add(wanted(hazard="loud"), approved=False)
    assert runs.queued("sim", 1) == []
    assert runs.approve(run.id, "bert")
    assert runs.queued("sim", 1)[0].approved_by == "bert"
    assert not runs.approve(run.id, "bert")


@pytest.mark.slow
@given(st.lists(st.tuples(st.sampled_from("ab"), st.integers(-3, 3)), max_size=12))
def test_each_bench_gets_its_runs_by_priority_and_then_as_they_came(asked: list[tuple[str, int]]) -> None:
    engine = _in_memory()
    runs = RunStore(engine)
    for bench in "ab":
        BenchStore(engine, "me").hold(bench)
    added = [(b, -p, runs.add(wanted(b, priority=p), approved=True)[0].id) for b, p in asked]
    for bench in "ab":
        order = []
        while found := runs.queued(bench, 1):
            [run] = found
            runs.take(run.id, "me")
            order.append(run.id)
        assert order == [number for b, _, number in sorted(added) if b == bench]


def test_only_its_holders_runs_come_while_a_bench_is_leased(engine: Engine) -> None:
    runs, leases = RunStore(engine), LeaseStore(engine)
    turns = Turns(runs, leases, ReservationStore(engine), Durations(DurationStore(engine)))
    run, _ = runs.add(wanted(by="anna"), approved=True)
    assert turns.next_of("sim") == run
    leases.take("sim", "bert", 60.0)
    assert turns.next_of("sim") is None
    leases.take("sim", "bert", -1.5)
    leases.take("sim", "anna", 60.0)
    assert turns.next_of("sim") == run
    leases.take("sim", "anna", -1.5)
    assert leases.take("sim", "bert", 60.0).holder == "bert"
    assert leases.take("sim", "anna", 60.0) is None
    assert leases.take("sim", "bert", -1.5) is not None  # its time is over: no one has it
    assert leases.of("sim") is None
    assert leases.take("sim", "anna", 60.0) is not None
    leases.give_back("sim")
    assert leases.of("sim") is None


def test_a_token_is_known_by_its_secret_which_is_kept_nowhere(engine: Engine, tmp_path: Path) -> None:
    tokens = TokenStore(engine)
    assert not tokens.any()
    made = tokens.make("anna", "operator")
    assert tokens.owner_of(made.secret) == made.token
    assert tokens.owner_of(made.secret + "x") is None
    assert made.secret.encode() not in b"".join(path.read_bytes() for path in tmp_path.iterdir())
    assert tokens.revoke(made.token.id)
    assert tokens.owner_of(made.secret) is None
    assert not tokens.any()


@pytest.mark.parametrize("change", ["UPDATE audit SET who = 'x'", "DELETE FROM audit"])
def test_the_database_itself_keeps_the_audit_log_as_it_is(engine: Engine, change: str) -> None:
    log = LogStore(engine)
    log.add("anna", "operator", "queue", "run 1")
    with engine.connect() as connection, pytest.raises(DBAPIError, match="append-only"):
        connection.execute(text(change))
    assert [(one.who, one.action) for one in log.newest(100, 10)] == [("anna", "queue")]


def test_a_bench_is_one_services_until_it_is_unheard_of_and_has_no_run(engine: Engine) -> None:
    one, other, runs = (
        BenchStore(engine, "one", "here"),
        BenchStore(engine, "other", "there"),
        RunStore(engine),
    )
    assert (one.hold("b"), other.hold("b"), other.hold("c")) == ("", "here", "")
    run, _ = runs.add(wanted("b"), approved=True)
    assert runs.take(run.id, "other") is None
    assert runs.take(run.id, "one") is not None
    one.hold("b", -2.0)
    assert "unheard of since" in other.hold("b")  # its run may be under way all the same
    assert (runs.running("other"), [found.id for found in runs.running("one")]) == ([], [run.id])
    runs.end(run.id, "ended")
    assert (other.hold("b"), one.hold("b")) == ("", "there")
    other.give_back()
    assert one.hold("b") == ""


def test_of_many_who_try_at_once_one_gets_it(engine: Engine) -> None:
    runs, leases = RunStore(engine), LeaseStore(engine)
    run, _ = runs.add(wanted(), approved=True)
    with ThreadPoolExecutor(8) as several:
        taken = list(several.map(lambda _: runs.take(run.id, "me"), range(16)))
        leased = list(several.map(lambda who: leases.take("sim", str(who), 60.0), range(16)))
        held = list(several.map(lambda who: BenchStore(engine, str(who)).hold("rig"), range(16)))
        same = list(several.map(lambda _: runs.add(wanted(key="k"), approved=True), range(16)))
    assert [one is not None for one in taken].count(True) == 1
    assert [one is not None for one in leased].count(True) == 1
    assert held.count("") == 1
    assert len({found.id for found, _ in same}) == [is_new for _, is_new in same].count(True) == 1


def test_moments_are_the_same_wherever_the_database_is(engine: Engine) -> None:
    run, _ = RunStore(engine).add(wanted(), approved=True)
    found = RunStore(engine).get(run.id).queued_at
    assert (found, found.tzinfo) == (run.queued_at, datetime.UTC)


def test_what_no_database_can_be_is_said_without_its_password() -> None:
    for url in (
        "postgresql+none://hil:secret@h/n",
        "mysql://hil:secret@h/n",
        "hil:secret",
        "postgresql://hil:secret@h/n?sslmode=x",
        "postgresql://hil:secret@h/n?sslmode=verify-full&sslrootcert=/none",
    ):
        with pytest.raises(BadInputError, match="no database can be opened") as refused:
            open_database(url)
        assert "secret" not in str(refused.value)
    with pytest.raises(BenchError, match="cannot be used") as unreached:
        open_database("postgresql://hil:secret@127.0.0.1:9/n")
    assert "secret" not in str(unreached.value)


def _in_memory() -> Engine:
    engine = create_engine("sqlite://")
    Base.metadata.create_all(engine)
    return engine


def test_plots_are_kept_by_person_and_plan_and_the_oldest_give_way(
    engine: Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hil.service.store._layouts.MOST_OF_ONE", 2)
    layouts = LayoutStore(engine)
    layouts.keep("bert", "a", "x")
    for plan, text_ in (("a", "one"), ("b", "two"), ("a", "three")):
        layouts.keep("anna", plan, text_)
    assert [layouts.of("anna", "a"), layouts.of("anna", "b"), layouts.of("bert", "a")] == [
        "three",
        "two",
        "x",
    ]
    layouts.keep("anna", "c", "four")
    assert layouts.of("anna", "c") == "four"
    assert [layouts.of("anna", plan) for plan in "ab"].count("") == 1
    layouts.forget("anna", "c")
    assert (layouts.of("anna", "c"), layouts.of("bert", "a")) == ("", "x")
