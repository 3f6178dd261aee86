"""Notes and tags of runs: kept, found by, removed by who may."""

from __future__ import annotations

import unicodedata
from urllib.parse import quote

import pytest
from pydantic import TypeAdapter, ValidationError
from sqlalchemy import Engine, insert
from sqlalchemy.orm import sessionmaker

from hil.api_schemas.notes import MOST_NOTES, MOST_TAGS, Tag
from hil.api_schemas.run_list import RunsWanted
from hil.client import Client
from hil.core.errors import BadInputError
from hil.service.store import Base, NoteStore, RunList
from tests.hil.service.served import SHORT, RefusedError, Served
from tests.hil.service.test_access import tokens as tokens  # a service with people of every role
from tests.hil.service.test_run_list import a_run

_RUNS = Base.metadata.tables["runs"]


@pytest.fixture
def notes(engine: Engine) -> NoteStore:
    with sessionmaker(engine).begin() as session:
        session.execute(insert(_RUNS), [a_run(number) for number in (1, 2, 3)])
    return NoteStore(engine)


def test_notes_come_oldest_first_and_are_those_of_their_run(notes: NoteStore) -> None:
    first = notes.add(1, "anna", "noise at the left wheel")
    notes.add(2, "bert", "other run")
    second = notes.add(1, "bert", "bearing changed\nsince then quiet")
    assert notes.of(1).notes == [first, second]
    assert notes.get(2, first.id) is None
    notes.remove(first.id)
    assert [one.text for one in notes.of(1).notes] == ["bearing changed\nsince then quiet"]


def test_a_tag_stands_once_and_runs_are_found_by_any_of_several(notes: NoteStore, engine: Engine) -> None:
    for run, tag in ((1, "noisy"), (1, "noisy"), (1, "axle-7"), (3, "cold")):
        notes.tag(run, tag, "anna")
    assert notes.of(1).tags == ["axle-7", "noisy"]
    listed = RunList(engine)
    found = listed.find(RunsWanted(tag=["noisy", "cold"]))
    assert [(one.run.id, one.tags) for one in found.runs] == [(3, ["cold"]), (1, ["axle-7", "noisy"])]
    assert found.total == 2
    assert listed.find(RunsWanted(tag=["nothing"])).runs == []
    assert listed.choices([]).tags == ["axle-7", "cold", "noisy"]
    assert notes.untag(1, "noisy")
    assert not notes.untag(1, "noisy")
    assert listed.choices([]).tags == ["axle-7", "cold"]


def test_there_are_not_more_than_can_be_read(notes: NoteStore) -> None:
    for number in range(MOST_TAGS):
        notes.tag(1, f"tag-{number}", "anna")
    notes.tag(1, "tag-0", "bert")  # it has it already
    with pytest.raises(BadInputError, match=f"has {MOST_TAGS} tags"):
        notes.tag(1, "one-more", "anna")
    for number in range(MOST_NOTES):
        notes.add(2, "anna", str(number))
    with pytest.raises(BadInputError, match=f"has {MOST_NOTES} notes"):
        notes.add(2, "anna", "one more")


@pytest.fixture
def run(tokens: tuple[Served, dict[str, str]]) -> int:
    service, _ = tokens
    service.give("short", SHORT)
    one = service.queue()
    service.over(one)
    return one


@pytest.mark.slow
def test_ones_own_note_goes_and_that_of_others_only_by_an_engineer(
    tokens: tuple[Served, dict[str, str]], run: int
) -> None:
    service, secrets = tokens
    path = f"/api/v1/runs/{run}/notes"
    note = service.ask("POST", path, {"text": "by the engineer"}, token=secrets["engineer"])
    with pytest.raises(RefusedError, match="ask an engineer") as refused:
        service.ask("DELETE", f"{path}/{note['id']}", token=secrets["operator"])
    assert refused.value.status == 403
    own = service.ask("POST", path, {"text": "by the operator"}, token=secrets["operator"])
    service.ask("DELETE", f"{path}/{own['id']}", token=secrets["operator"])
    service.ask("DELETE", f"{path}/{note['id']}", token=secrets["engineer"])
    assert service.ask("GET", path, token=secrets["viewer"])["notes"] == []
    actions = [entry["action"] for entry in service.get("/audit") if entry["target"] == f"run {run}"]
    assert actions[:4] == ["note removed", "note removed", "note added", "note added"]


@pytest.mark.slow
def test_a_client_adds_both_and_nonsense_is_refused(tokens: tuple[Served, dict[str, str]], run: int) -> None:
    service, secrets = tokens
    client = Client(service.url, secrets["operator"])
    client.add_note(run, "seen at 12 s")
    client.tag(run, "axle-7")
    client.tag(run, "試験_２号")
    assert [one.run.id for one in client.find_runs(RunsWanted(tag=["試験_２号"])).runs] == [run]
    service.ask("DELETE", f"/api/v1/runs/{run}/tags/{quote('試験_２号')}", token=secrets["operator"])
    found = client.notes(run)
    assert (found.tags, [one.text for one in found.notes]) == (["axle-7"], ["seen at 12 s"])
    assert [one.run.id for one in client.find_runs(RunsWanted(tag=["axle-7"])).runs] == [run]
    for method, path, body in (
        ("PUT", f"/runs/{run}/tags/two%20words", None),
        ("POST", f"/runs/{run}/notes", {"text": "  "}),
        ("PUT", "/runs/2000000000/tags/a", None),
    ):
        with pytest.raises(RefusedError) as refused:
            service.ask(method, f"/api/v1{path}", body)
        assert refused.value.status in (404, 422)


@pytest.mark.parametrize("tag", ["騒音", "ノイズ", "Geräusch", "шум-2", "é" * 40, "หมี", "a.b:c-d_e"])
def test_a_tag_has_letters_and_digits_of_any_script(tag: str) -> None:
    assert TypeAdapter(Tag).validate_python(tag) == tag
    assert TypeAdapter(Tag).validate_python(unicodedata.normalize("NFD", tag[:3])) == tag[:3]


@pytest.mark.parametrize(
    "tag", ["", "two words", "a/b", "-a", "\u0301a", "a" * 41, "a\n", "😀", "a\u200b", "a,b"]
)
def test_what_is_no_word_is_no_tag(tag: str) -> None:
    with pytest.raises(ValidationError):
        TypeAdapter(Tag).validate_python(tag)
