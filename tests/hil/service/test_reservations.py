"""Reservations, which never meet and for which runs of others wait; durations; hand-over notes."""

from __future__ import annotations

import datetime

import pytest
from sqlalchemy import Engine, insert, update
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.team import HandoverWanted, ReservationWanted
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


@pytest.mark.parametrize(
    "moment", ["0001-01-01T00:00:00+14:00", "9999-12-31T23:59:59-14:00", "2026-11-28T08:00"]
)
def test_a_moment_is_of_our_time_and_has_a_zone(moment: str) -> None:
    with pytest.raises(ValueError, match="more than a day ago|more than a year ahead|timezone"):
        ReservationWanted.model_validate({"begins": moment, "ends": moment, "reason": "x"})


@pytest.mark.parametrize("hours", [-25, 367 * 24])
def test_a_moment_is_near_now(hours: float) -> None:
    with pytest.raises(ValueError, match="more than a day ago|more than a year ahead"):
        _wanted(hours, hours + 1)


@pytest.mark.parametrize("day", ["1900-01-01", "2999-12-31"])
def test_a_note_is_of_a_day_near_today(day: str) -> None:
    with pytest.raises(ValueError, match="before yesterday|more than a year ahead"):
        HandoverWanted.model_validate({"day": day, "shift": "early", "text": "quiet"})
    for days in (-1, 0, 365):
        near = (_now() + datetime.timedelta(days=days)).date()
        assert HandoverWanted(day=near, shift="early", text="quiet").day == near


@pytest.mark.parametrize("text", ["", "   ", "\n", "a\0b"])
def test_a_note_and_a_reason_say_something(text: str) -> None:
    day = _now().date()
    with pytest.raises(ValueError, match="text"):
        HandoverWanted(day=day, shift="early", text=text)
    with pytest.raises(ValueError, match="reason"):
        _wanted(1, 2, text)


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
    store, day = HandoverStore(engine), datetime.datetime.now(datetime.UTC).date()
    first = store.add("sim", "anna", HandoverWanted(day=day, shift="early", text="oil changed\nruns 1 to 4"))
    second = store.add("sim", "bert", HandoverWanted(day=day, shift="late", text="sensor drifts"))
    store.add("other", "bert", HandoverWanted(day=day, shift="late", text="elsewhere"))
    assert store.of("sim", 2**31 - 1, 10) == [second, first]
    assert store.of("sim", second.id, 10) == [first]
    assert store.of("sim", 2**31 - 1, 1) == [second]
    assert (first.day, first.shift, first.text) == (day, "early", "oil changed\nruns 1 to 4")
