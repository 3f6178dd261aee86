"""Refusals in plain words: which field, what is wrong with it, what would be right."""

from __future__ import annotations

import datetime
from typing import Any

import pytest

from tests.hil.service.served import RefusedError, Served

_NOW = datetime.datetime.now(datetime.UTC).replace(microsecond=0)


def _moment(hours: float) -> str:
    return (_NOW + datetime.timedelta(hours=hours)).isoformat()


def _problem(service: Served, method: str, path: str, body: object = None) -> Any:
    with pytest.raises(RefusedError) as refused:
        service.ask(method, f"/api/v1{path}", body)
    assert refused.value.status == 422
    return refused.value.problem


@pytest.mark.parametrize(
    ("path", "body", "where", "what"),
    [
        ("/recordings", {"name": "a.csv", "size": 0}, "size", "must be at least 1, not 0"),
        (
            "/recordings",
            {"name": "mät.csv", "size": 1},
            "name",
            "must have 1 to 100 letters from A to Z, digits and _ . -, and begin with a letter or digit",
        ),
        (
            "/benches/sim/reservations",
            {"begins": _moment(2), "ends": _moment(1), "reason": "x"},
            "",
            "ends must be later than begins, by 31 days at most",
        ),
        (
            "/benches/sim/reservations",
            {"begins": "2026-03-01T10:00", "ends": _moment(1), "reason": "x"},
            "begins",
            "must be a date and a time with their zone, as 2026-03-01T14:30:00+01:00",
        ),
        (
            "/benches/sim/reservations",
            {"begins": "1900-01-01T10:00:00Z", "ends": _moment(1), "reason": "x"},
            "begins",
            "must not be more than a day ago",
        ),
        (
            "/benches/sim/reservations",
            {"begins": _moment(1), "ends": _moment(2), "reason": " "},
            "reason",
            "must have something in it, and no control characters",
        ),
        (
            "/benches/sim/reservations",
            {"begins": _moment(1), "ends": _moment(2), "reason": "r" * 201},
            "reason",
            "must have at most 200 characters",
        ),
        (
            "/benches/sim/handovers",
            {"day": "2999-01-01", "shift": "early", "text": "x"},
            "day",
            "must not be more than a year ahead",
        ),
        (
            "/benches/sim/handovers",
            {"day": "today", "shift": "early", "text": "x"},
            "day",
            "must be a date, as 2026-03-01",
        ),
        (
            "/benches/sim/handovers",
            {"day": f"{_NOW:%Y-%m-%d}", "shift": "dog", "text": "x"},
            "shift",
            "must be 'early', 'day', 'late' or 'night'",
        ),
        ("/runs", {"plan": "short", "bench": "sim", "dut": 3}, "dut", "is not known here"),
        ("/runs", {"plan": "short"}, "bench", "is missing"),
        ("/runs", None, "", "the request has no content"),
        ("/runs", [], "", "must be a JSON object"),
    ],
)
def test_a_field_is_named_with_what_would_be_right(
    service: Served, path: str, body: object, where: str, what: str
) -> None:
    assert _problem(service, "POST", path, body) == {"what": what, "where": where, "fix": ""}


def test_every_field_that_is_wrong_is_named(service: Served) -> None:
    found = _problem(service, "POST", "/recordings", {"name": "", "size": 0, "colums": []})
    assert found["what"].startswith("3 fields are wrong\n")
    for line in (
        "\n  size must be at least 1, not 0",
        "\n  colums is not known here",
        "\n  name must have 1 to",
    ):
        assert line in found["what"]


def test_of_very_many_fields_some_are_named_and_all_are_counted(service: Served) -> None:
    found = _problem(service, "POST", "/recordings", {f"k{number}": 1 for number in range(1000)})
    assert found["what"].startswith("1002 fields are wrong\n")
    assert found["what"].endswith("\n  and 982 more")
    assert len(found["what"]) < 2000


def test_a_parameter_of_an_address_is_named(service: Served) -> None:
    found = _problem(service, "GET", "/runs?most=0")
    assert (found["where"], found["what"]) == ("most", "must be at least 1")


def test_a_body_that_is_no_json_is_called_that(service: Served) -> None:
    with pytest.raises(RefusedError) as refused:
        service.ask("POST", "/api/v1/runs", "plan: short")
    assert refused.value.status in (400, 422)
    assert "body" not in refused.value.problem["where"]


def test_a_wrong_token_says_what_may_be_wrong_with_it(service: Served) -> None:
    with pytest.raises(RefusedError) as refused:
        service.post("/session", {"secret": "nonsense"})
    assert refused.value.status == 401
    assert refused.value.problem["what"] == "this token is not known, has expired or was revoked"
    assert "administrator" in refused.value.problem["fix"]
