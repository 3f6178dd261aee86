"""A bench that several people share, at the real service: reservations, leases, who watches."""

from __future__ import annotations

import datetime
import http.client
import json
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest

from hil.client import Client, RefusedError
from hil.client import RunWanted as Wanted
from tests.hil.service.served import SHORT, Served
from tests.hil.service.test_access import tokens as tokens  # a service with people of every role

pytestmark = pytest.mark.slow
_HOUR = datetime.timedelta(hours=1)


def _now() -> datetime.datetime:
    return datetime.datetime.now(datetime.UTC).replace(microsecond=0)


@pytest.fixture
def clients(tokens: tuple[Served, dict[str, str]]) -> Iterator[dict[str, Client]]:
    service, secrets = tokens
    found = {role: Client(service.url, secrets[role]) for role in ("viewer", "operator", "engineer", "admin")}
    yield found
    for bench in found["admin"].reservations("sim"):
        found["admin"].remove_reservation("sim", bench.id)


def test_a_bench_says_until_when_it_is_leased(clients: dict[str, Client]) -> None:
    operator = clients["operator"]
    lease = operator.lease("sim", 60.0)
    assert operator.bench("sim").lease_until == lease.until
    operator.give_back("sim")
    assert operator.bench("sim").lease_until is None


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
    assert operator.bench("sim").reserved_by == "the engineer"
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
    admin.remove_reservation("sim", held.id)
    assert operator.reservations("sim") == []
    done = [one.action for one in admin.audit(30)]
    assert {"reserve", "run admitted", "reservation removed"} <= set(done)


def test_a_reservation_is_refused_while_somebody_has_a_lease(clients: dict[str, Client]) -> None:
    clients["operator"].lease("sim", 3600)
    with pytest.raises(RefusedError, match="the operator holds the bench until"):
        clients["engineer"].reserve("sim", _now(), _now() + _HOUR, "mine")
    clients["operator"].reserve("sim", _now() + 2 * _HOUR, _now() + 3 * _HOUR, "mine")
    clients["operator"].give_back("sim")


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


def test_those_who_watch_see_a_reservation_begin_and_end(
    clients: dict[str, Client], tokens: tuple[Served, dict[str, str]]
) -> None:
    service, secrets = tokens
    states = _watch(service, secrets["viewer"])
    assert next(states)["bench"]["reserved_by"] == ""
    second = datetime.timedelta(seconds=1)
    now = datetime.datetime.now(datetime.UTC)
    clients["engineer"].reserve("sim", now + 2 * second, now + 5 * second, "soon, and short")
    while next(states)["bench"]["reserved_by"] != "the engineer":
        continue
    while next(states)["bench"]["reserved_by"] != "":
        continue
    states.close()


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
