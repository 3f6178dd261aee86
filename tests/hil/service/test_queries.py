"""Runs are filtered by what is asked for, and what an address does not know is refused by name."""

from __future__ import annotations

import datetime

import pytest

from tests.hil.service.served import SHORT, RefusedError, Served

STRICT = SHORT.replace("name: short", "name: strict").replace("upper: 400", "upper: 1")


def test_runs_are_filtered_by_verdict_and_say_when_they_started(service: Served) -> None:
    service.give("strict", STRICT)
    passed, failed = service.queue(), service.queue("strict")
    for run in (passed, failed):
        service.over(run)

    def listed(query: str) -> list[int]:
        return [run["id"] for run in service.get(f"/runs?{query}")]

    assert failed in listed("verdict=fail")
    assert passed not in listed("verdict=fail")
    assert {passed, failed} <= set(listed("verdict=pass&verdict=fail"))
    assert listed("verdict=error&state=queued") == []
    began, over = (
        datetime.datetime.fromisoformat(text)
        for text in (
            service.get(f"/runs/{passed}/files/result.json")["started_at"],
            service.get(f"/runs/{passed}")["ended_at"],
        )
    )
    assert began.utcoffset() == datetime.timedelta()
    assert began < over


@pytest.mark.parametrize(
    ("path", "where", "fix"),
    [
        ("/runs?verdikt=fail", "query.verdikt", "did you mean 'verdict'?"),
        ("/runs?bench=sim&a%0Ab=1", "query.a", "known: before, bench, most, state, step, verdict"),
        ("/benches?name=sim", "query.name", "this address takes none"),
        ("/trends?bench=sim&plan=short&last=3", "query.last", "known: "),
    ],
)
def test_a_parameter_that_there_is_not_is_refused_by_name(service: Served, path, where, fix) -> None:
    with pytest.raises(RefusedError) as caught:
        service.get(path)
    assert caught.value.status == 422
    assert caught.value.problem["where"].startswith(where)
    assert fix in caught.value.problem["fix"]


def test_a_verdict_that_there_is_not_is_refused(service: Served) -> None:
    with pytest.raises(RefusedError) as caught:
        service.get("/runs?verdict=failed")
    assert caught.value.status == 422


def test_an_emergency_stop_is_never_refused_for_a_word_too_many(service: Served) -> None:
    service.post("/benches/sim/emergency-stop?why=smoke")
    assert service.get("/benches/sim")["state"] == "emergency_stop"
    service.post("/benches/sim/reset")
