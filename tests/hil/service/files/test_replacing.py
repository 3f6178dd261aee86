"""Two people write one plan: who saves second does not replace what they have not seen."""

from __future__ import annotations

import hashlib
import re
import urllib.request
from collections.abc import Iterator

import pytest

from tests.hil.service.served import SHORT, RefusedError, Served

FIRST = SHORT.replace("name: short", "name: shared")
MINE, THEIRS = FIRST.replace("upper: 400", "upper: 380"), FIRST.replace("upper: 400", "upper: 390")


@pytest.fixture
def shared(service: Served) -> Iterator[Served]:
    """With a plan of two people, which is removed afterwards."""
    service.give("shared", FIRST)
    yield service
    if any(one["name"] == "shared" for one in service.get("/plans")):
        service.ask("DELETE", "/api/v1/plans/shared")


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _save(there: Served, text: str, instead_of: str) -> None:
    there.ask("PUT", f"/api/v1/plans/shared?instead_of={instead_of}", text)


def test_a_text_has_the_tag_by_which_it_is_replaced(shared: Served) -> None:
    with urllib.request.urlopen(f"{shared.url}/api/v1/plans/shared/text") as answer:
        assert answer.headers["etag"] == f'"{_sha256(FIRST)}"'
    with urllib.request.urlopen(f"{shared.url}/api/v1/plans/acceptance/text") as answer:
        assert answer.headers["etag"] is None  # it cannot be replaced


def test_who_saves_second_is_refused_and_told_whose_text_is_there(shared: Served) -> None:
    _save(shared, THEIRS, _sha256(FIRST))
    with pytest.raises(RefusedError) as refused:
        _save(shared, MINE, _sha256(FIRST))
    assert refused.value.status == 409
    problem = refused.value.problem
    said = r"was saved by local at \d{4}-\d\d-\d\d \d\d:\d\d UTC, after you began to write"
    assert re.fullmatch(said, problem["what"])
    assert problem["where"] == "shared"
    assert "compare both texts" in problem["fix"]
    assert shared.get("/plans/shared/text").decode() == THEIRS
    _save(shared, MINE, _sha256(THEIRS))  # once they have seen it
    assert shared.get("/plans/shared/text").decode() == MINE


def test_the_same_text_is_saved_again_whatever_it_was_made_from(shared: Served) -> None:
    _save(shared, MINE, _sha256(FIRST))
    _save(shared, MINE, _sha256(FIRST))  # the answer to the first time went astray
    assert len(shared.get("/versions/plan/shared")) >= 2


def test_a_new_plan_replaces_none(shared: Served) -> None:
    with pytest.raises(RefusedError, match=r"was saved by local at [-0-9: ]+ UTC', ") as refused:
        _save(shared, MINE, "")
    assert refused.value.status == 409
    assert shared.get("/plans/shared/text").decode() == FIRST


def test_a_plan_that_was_removed_meanwhile_does_not_come_back_unasked(shared: Served) -> None:
    shared.ask("DELETE", "/api/v1/plans/shared")
    with pytest.raises(RefusedError, match="was removed after you began to write") as refused:
        _save(shared, MINE, _sha256(FIRST))
    assert refused.value.status == 409
    _save(shared, MINE, "")
    assert shared.get("/plans/shared/text").decode() == MINE
