"""Reservations, which never meet and for which runs of others wait; hand-over notes; who is there."""

from __future__ import annotations

import datetime
import http.client
import json
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
from sqlalchemy import Engine, insert, update
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.team import HandoverWanted, ReservationWanted
from hil.client import Client, RefusedError
from hil.client import RunWanted as Wanted
from hil.core.errors import BadInputError
from hil.service.durations import Durations
from hil.service.store import (
    Base,
    DurationStore,
    HandoverStore,
    LeaseStore,
    ReservationStore,
    RunStore,
)
from hil.service.turns import Turns
from tests.hil.service.served import SHORT, Served
from tests.hil.service.test_access import tokens as tokens  # a service with people of every role
from tests.hil.service.test_run_list import a_run

_RUNS = Base.metadata.tables["runs"]
_HOUR = datetime.timedelta(hours=1)


def _now() -> datetime.datetime:
    return datetime.datetime.now(datetime.UTC).replace(microsecond=0)


def _wanted(begins: float, ends: float, reason: str = "end of line") -> ReservationWanted:
    """From so many hours from now to so many."""
    return ReservationWanted(begins=_now() + begins * _HOUR, ends=_now() + ends * _HOUR, reason=reason)


def test_two_reservations_never_meet(engine: Engine) -> None:
    store = ReservationStore(engine)
    first, is_new = store.add("sim", "anna", _wanted(1, 2))
    assert (is_new, first.who, first.reason) == (True, "anna", "end of line")
    for begins, ends in ((0.5, 1.5), (1.2, 1.8), (1.9, 3), (0, 9)):
        assert store.add("sim", "bert", _wanted(begins, ends)) == (first, False)
    assert store.add("other", "bert", _wanted(1, 2))[1]
    after, is_new = store.add(
        "sim", "bert", ReservationWanted(begins=first.ends, ends=first.ends + _HOUR, reason="x")
    )
    assert is_new
    assert store.of("sim") == [first, after]
    with pytest.raises(BadInputError, match="would be over"):
        store.add("sim", "bert", _wanted(-3, -2))
    store.admit(first.id, 7)
    store.admit(first.id, 7)
    assert store.of("sim")[0].admitted == [7]
    assert store.get("other", first.id) is None
    store.remove(first.id)
    assert store.of("sim") == [after]


@pytest.mark.parametrize(("begins", "ends"), [(2, 1), (1, 1), (0, 24 * 31 + 1)])
def test_a_reservation_has_a_length(begins: float, ends: float) -> None:
    with pytest.raises(ValueError, match="31 days"):
        _wanted(begins, ends)


def test_whose_turn_it_is_within_a_reservation(engine: Engine) -> None:
    runs, reservations = RunStore(engine), ReservationStore(engine)
    queued = {"state": "queued", "ended_at": None, "bench": "sim"}
    people = {1: "anna", 2: "bert", 3: "anna"}
    with sessionmaker(engine).begin() as session:
        for number, who in people.items():
            session.execute(insert(_RUNS), [a_run(number) | queued | {"requested_by": who}])
        session.execute(update(_RUNS).where(_RUNS.c.id == 3).values(priority=5))
    turns = Turns(runs, LeaseStore(engine), reservations, Durations(DurationStore(engine)))
    assert turns.next_of("sim").id == 3
    of_bert, _ = reservations.add("sim", "bert", _wanted(-1, 1))
    assert turns.next_of("sim").id == 2
    reservations.admit(of_bert.id, 1)
    assert turns.next_of("sim").id == 1
    reservations.remove(of_bert.id)
    reservations.add("sim", "carl", _wanted(-1, 1))
    assert turns.next_of("sim") is None


def test_a_run_that_took_longer_before_does_not_start_before_a_reservation(engine: Engine) -> None:
    begun = datetime.datetime(2026, 11, 28, tzinfo=datetime.UTC)
    same = {"bench": "sim", "plan": "p", "plan_text": "t", "requested_by": "anna"}
    ended = {"started_at": begun, "ended_at": begun + 2 * _HOUR, "state": "ended", "verdict": "pass"}
    queued = {"started_at": None, "ended_at": None, "state": "queued", "verdict": None}
    with sessionmaker(engine).begin() as session:
        for row in ({"id": 1} | ended, {"id": 2} | queued, {"id": 3, "plan_text": "shorter"} | queued):
            session.execute(insert(_RUNS), [a_run(1) | same | row])
    reservations = ReservationStore(engine)
    turns = Turns(RunStore(engine), LeaseStore(engine), reservations, Durations(DurationStore(engine)))
    assert turns.next_of("sim").id == 2
    reservations.add("sim", "bert", _wanted(1, 2))
    assert turns.next_of("sim").id == 3


def test_a_run_takes_as_long_as_the_newest_of_the_same_plan(engine: Engine) -> None:
    begun = datetime.datetime(2026, 11, 28, tzinfo=datetime.UTC)
    rows = []
    for number, (seconds, verdict) in enumerate([(90, "pass"), (10, "error"), (60, "fail"), (70, "pass")], 1):
        ended = begun + datetime.timedelta(seconds=seconds)
        rows.append(
            a_run(number) | {"started_at": begun, "ended_at": ended, "verdict": verdict, "plan_text": "t"}
        )
    rows.append(a_run(5) | {"started_at": None, "ended_at": None, "state": "queued", "plan_text": "t"})
    rows.append(a_run(6) | {"started_at": None, "ended_at": None, "state": "queued", "plan_text": "other"})
    with sessionmaker(engine).begin() as session:
        for row in rows:
            session.execute(insert(_RUNS), [row | {"plan": "p", "bench": "sim"}])
    store = DurationStore(engine)
    assert store.measured_s(5) == 70.0
    assert store.measured_s(6) is None
    assert store.measured_s(99) is None


def test_hand_over_notes_come_newest_first_and_stay(engine: Engine) -> None:
    store, day = HandoverStore(engine), datetime.date(2026, 11, 28)
    first = store.add("sim", "anna", HandoverWanted(day=day, shift="early", text="oil changed\nruns 1 to 4"))
    second = store.add("sim", "bert", HandoverWanted(day=day, shift="late", text="sensor drifts"))
    store.add("other", "bert", HandoverWanted(day=day, shift="late", text="elsewhere"))
    assert store.of("sim", 2**31 - 1, 10) == [second, first]
    assert store.of("sim", second.id, 10) == [first]
    assert store.of("sim", 2**31 - 1, 1) == [second]
    assert (first.day, first.shift, first.text) == (day, "early", "oil changed\nruns 1 to 4")


@pytest.fixture
def clients(tokens: tuple[Served, dict[str, str]]) -> Iterator[dict[str, Client]]:
    service, secrets = tokens
    found = {role: Client(service.url, secrets[role]) for role in ("viewer", "operator", "engineer", "admin")}
    yield found
    for bench in found["admin"].reservations("sim"):
        found["admin"].remove_reservation("sim", bench.id)


@pytest.mark.slow
def test_a_queued_run_waits_for_a_reservation_and_says_why(
    clients: dict[str, Client], tokens: tuple[Served, dict[str, str]]
) -> None:
    operator, engineer, admin = clients["operator"], clients["engineer"], clients["admin"]
    engineer.give_plan("short", SHORT)
    held = engineer.reserve("sim", _now() - _HOUR / 60, _now() + _HOUR, "endurance")
    run = operator.queue(Wanted(plan="short", bench="sim"))
    [waiting] = operator.queue_of("sim")
    assert waiting.waits_for == held
    assert waiting.expected_start == held.ends
    assert operator.run(run.id).waits_for == held
    own = engineer.queue(Wanted(plan="short", bench="sim"))
    *_, last = engineer.progress(own.id)
    assert last.verdict == "pass"
    assert operator.run(run.id).state == "queued"
    with pytest.raises(RefusedError, match="the engineer has reserved the bench from .* to .*: endurance"):
        operator.reserve("sim", _now(), _now() + _HOUR, "mine")
    with pytest.raises(RefusedError, match="the engineer has reserved the bench"):
        operator.lease("sim")
    for refused in (
        lambda: operator.remove_reservation("sim", held.id),
        lambda: operator.admit("sim", held.id, run.id),
    ):
        with pytest.raises(RefusedError, match="the reservation is the engineer's"):
            refused()
    engineer.admit("sim", held.id, run.id)
    *_, last = operator.progress(run.id)
    assert last.verdict == "pass"
    third = operator.queue(Wanted(plan="short", bench="sim"))
    admin.remove_reservation("sim", held.id)
    *_, last = operator.progress(third.id)
    assert last.verdict == "pass"
    done = [one.action for one in admin.audit(30)]
    assert {"reserve", "run admitted", "reservation removed"} <= set(done)


@pytest.mark.slow
def test_a_reservation_is_refused_while_somebody_has_a_lease(clients: dict[str, Client]) -> None:
    clients["operator"].lease("sim", 3600)
    with pytest.raises(RefusedError, match="the operator holds the bench until"):
        clients["engineer"].reserve("sim", _now(), _now() + _HOUR, "mine")
    clients["operator"].reserve("sim", _now() + 2 * _HOUR, _now() + 3 * _HOUR, "mine")
    clients["operator"].give_back("sim")


@pytest.mark.slow
def test_those_who_watch_a_bench_are_named(
    clients: dict[str, Client], tokens: tuple[Served, dict[str, str]]
) -> None:
    service, secrets = tokens
    first = _watch(service, secrets["viewer"])
    assert next(first)["viewers"] == ["the viewer"]
    second = _watch(service, secrets["operator"])
    assert next(second)["viewers"] == ["the operator", "the viewer"]
    while (names := next(first)["viewers"]) == ["the viewer"]:
        continue
    assert names == ["the operator", "the viewer"]
    second.close()
    while (names := next(first)["viewers"]) != ["the viewer"]:
        continue
    first.close()


def _watch(service: Served, token: str):
    """What a viewer of the bench is told of its state."""
    where = urlsplit(service.url)
    connection = http.client.HTTPConnection(where.hostname or "", where.port, timeout=60)
    try:
        connection.request("GET", "/api/v1/benches/sim/live", headers={"authorization": f"Bearer {token}"})
        with connection.getresponse() as answer:
            is_state = False
            while line := answer.readline().decode():
                if line.startswith("data:") and is_state:
                    yield json.loads(line[5:])
                is_state = line.strip() == "event: state" if line.startswith("event:") else is_state
    finally:
        connection.close()
