"""Versions of what people give: who gave which text when, families, and what a database had before them."""

from __future__ import annotations

from pathlib import Path

import alembic.command
import pytest
from sqlalchemy import Engine, text

from hil.service.store import GivenStore, VersionStore, open_database
from hil.service.store import _versions as versions


def test_every_text_of_a_plan_is_kept_with_who_gave_it(engine: Engine) -> None:
    store, history = GivenStore(engine), VersionStore(engine)
    for one, (by, content) in enumerate((("anna", "a"), ("ben", "b"), ("anna", "a"))):
        before = store.get("plan", "mine")
        assert store.give("plan", "mine", content, by, instead_of=before.sha256 if before else ""), one
    assert store.give("plan", "mine", "a", "carl")  # the same again is no version
    found = history.of("plan", "mine")
    assert [(one.number, one.given_by) for one in found] == [(3, "anna"), (2, "ben"), (1, "anna")]
    assert [history.text("plan", "mine", one.number) for one in found] == ["a", "b", "a"]
    assert history.text("plan", "mine", 4) is None
    assert history.of("plan", "other") == history.of("model", "mine") == []


def test_what_is_made_of_another_is_of_its_family_also_when_that_is_built_in(engine: Engine) -> None:
    store, history = GivenStore(engine), VersionStore(engine)
    store.give("model", "axle", "1", "anna")
    store.give("model", "axle_2", "2", "ben", based_on="axle")
    store.give("model", "axle_3", "3", "ben", based_on="axle_2")
    store.give("model", "own", "4", "ben", based_on="three_inertia")
    store.remove("model", "axle_2")
    assert [one.name for one in history.of("model", "axle_3")] == ["axle_3", "axle_2", "axle"]
    assert history.of("model", "axle") == history.of("model", "axle_2")
    assert history.text("model", "axle_3", 2) == "2"  # also of a removed one
    assert [one.name for one in history.of("model", "three_inertia")] == ["own"]


def test_a_text_that_was_refused_is_no_version(engine: Engine) -> None:
    store, history = GivenStore(engine), VersionStore(engine)
    store.give("controller", "one", "a", "anna")
    assert not store.give("controller", "one", "b", "ben")
    assert [one.given_by for one in history.of("controller", "one")] == ["anna"]


def test_a_picture_has_no_versions(engine: Engine) -> None:
    store = GivenStore(engine)
    assert store.give("picture", "cage.png", "iVBORw0KGgo=", "anna")
    with engine.connect() as connection:
        assert connection.execute(text("SELECT count(*) FROM given_versions")).scalar_one() == 0


def test_so_many_of_a_family_are_kept(engine: Engine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(versions, "_MOST_KEPT", 3)
    store, history = GivenStore(engine), VersionStore(engine)
    for number in range(1, 6):
        before = store.get("plan", "mine")
        store.give("plan", "mine", str(number), "anna", instead_of=before.sha256 if before else "")
    assert [one.number for one in history.of("plan", "mine")] == [5, 4, 3]


def test_what_an_earlier_version_had_begins_its_history(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url, upgrade = f"sqlite:///{tmp_path / 'service.sqlite'}", alembic.command.upgrade
    monkeypatch.setattr(alembic.command, "upgrade", lambda config, to: upgrade(config, "0009"))
    engine = open_database(url)
    columns = "kind, name, sha256, text, given_by, given_at"
    with engine.begin() as connection:
        connection.execute(
            text(
                f"INSERT INTO given ({columns}) VALUES ('plan', 'mine', 'x', 'a', 'anna', '2026-01-01 00:00')"
            )
        )
    engine.dispose()
    monkeypatch.undo()
    engine = open_database(url)
    assert [(one.name, one.given_by) for one in VersionStore(engine).of("plan", "mine")] == [("mine", "anna")]
    engine.dispose()
