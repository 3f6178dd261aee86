"""What people give: rows of a database that says who was first, files that follow them, folders of old."""

from __future__ import annotations

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import Engine

from hil.api_schemas.upload import KeptApart
from hil.core.errors import BadInputError
from hil.engine.bench.bench_file import shipped
from hil.service.files.catalogues import controller_catalogue, model_catalogue
from hil.service.files.legacy_import import LegacyImport
from hil.service.files.pictures import Pictures
from hil.service.files.plans import Plans
from hil.service.files.uploads import NameTakenError, Uploads
from hil.service.store import GivenStore, LogStore
from test_plans import library_controllers
from tests.hil.service.served import SHORT

CONTROLLER = library_controllers()["phase_stabilization"].read_text("utf-8")
MINE = SHORT.replace("name: short", "name: mine").replace("phase_stabilization.toml", "own.toml")


class _Here:
    """What a service of a database has of it, in a folder of its own."""

    def __init__(self, folder: Path, engine: Engine) -> None:
        self.folder, self.store, self.log = folder, GivenStore(engine), LogStore(engine)
        controllers = Uploads(self.store, "controller", folder / "given/plans", ".toml")
        self.files = Uploads(self.store, "plan", folder / "given/plans", ".yaml")
        pictures = Pictures(self.store, folder / "given/plans")
        self.plans = Plans(self.files, controllers, pictures)
        self.controllers = controller_catalogue(controllers)
        self.models = model_catalogue(Uploads(self.store, "model", folder / "given/models", ".toml"))

    def take_in(self) -> list[KeptApart]:
        catalogues = self.controllers, self.models
        return LegacyImport(self.folder, self.store, self.log, self.plans, *catalogues).take_in()

    def lay(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
        return path


@pytest.fixture
def one(tmp_path: Path, engine: Engine) -> _Here:
    return _Here(tmp_path / "one", engine)


@pytest.fixture
def other(tmp_path: Path, engine: Engine) -> _Here:
    return _Here(tmp_path / "other", engine)


def test_of_many_who_give_one_name_at_once_one_is_first(engine: Engine) -> None:
    store = GivenStore(engine)
    for name in ("a", "b", "c"):
        with ThreadPoolExecutor(8) as several:
            gave = [several.submit(store.give, "model", name, f"text {who}", str(who)) for who in range(8)]
        kept = [who for who, done in enumerate(gave) if done.result()]
        assert len(kept) == 1
        assert store.get("model", name).text == f"text {kept[0]}"


def test_of_many_who_replace_a_plan_at_once_one_does(engine: Engine) -> None:
    store = GivenStore(engine)
    store.give("plan", "p", "before", "anna")
    before = store.get("plan", "p").sha256
    with ThreadPoolExecutor(8) as several:
        gave = [
            several.submit(store.give, "plan", "p", f"text {who}", str(who), instead_of=before)
            for who in range(8)
        ]
    kept = [who for who, done in enumerate(gave) if done.result()]
    assert [store.get("plan", "p").text] == [f"text {who}" for who in kept]


def test_of_many_who_remove_one_at_once_one_does(one: _Here, other: _Here) -> None:
    for name in ("a", "b", "c"):
        text = SHORT.replace("name: short", f"name: {name}")
        one.plans.give(name, text, "anna")
        assert other.plans.text(name) == text
        with ThreadPoolExecutor(8) as several:
            removed = [several.submit(here.plans.remove, name) for here in 4 * [one, other]]
        assert sorted(done.result() for done in removed) == 7 * [False] + [True]
        assert (one.plans.text(name), other.plans.text(name)) == (None, None)
        assert not (one.files.folder / f"{name}.yaml").exists()
        other.plans.give(name, text, "bert")
        assert one.plans.text(name) == text, "the name is free again for all"


def test_a_name_that_was_removed_is_free_and_the_same_text_may_be_given_again(engine: Engine) -> None:
    store = GivenStore(engine)
    assert store.give("model", "m", "first", "anna")
    assert store.give("model", "m", "first", "bert")
    assert store.get("model", "m").given_by == "anna"
    assert not store.give("model", "m", "second", "bert")
    assert store.give("controller", "m", "of another kind", "bert")
    assert (store.remove("model", "m"), store.remove("model", "m")) == (True, False)
    assert (store.all("model"), store.get("model", "m").text) == ({}, "first")
    assert store.give("model", "m", "second", "bert")
    assert store.get("model", "m").given_by == "bert"


def test_a_file_is_that_of_its_row_whatever_happened_to_it(one: _Here, other: _Here) -> None:
    one.store.give("plan", "p", "text\r\n", "anna")  # and the service is killed before the file is written
    path = one.files.path("p")
    assert path is not None
    assert path.read_bytes() == b"text\r\n"
    path.write_text("by hand")
    assert one.files.paths() == {"p": path}
    assert path.read_bytes() == b"text\r\n"
    path.write_text("by hand")
    assert one.files.path("p").read_bytes() == b"text\r\n"
    path.unlink()
    assert one.files.paths()["p"].exists()
    one.lay("given/plans/laid-by-hand.yaml", SHORT)
    other.store.remove("plan", "p")
    assert (one.files.paths(), list(one.files.folder.iterdir())) == ({}, [])
    assert one.files.path("p") is None


def test_a_plan_loads_the_controllers_that_the_database_has_now(one: _Here, other: _Here) -> None:
    with pytest.raises(BadInputError, match=r"own\.toml"):
        one.plans.give("mine", MINE, "anna")
    other.controllers.give("own", CONTROLLER, "bert")
    assert one.plans.give("mine", MINE, "anna").name == "mine"
    assert other.plans.chosen("mine", {}) is not None
    shutil.rmtree(other.folder)
    assert [found.name for found in other.plans.all() if not found.built_in] == ["mine"]
    assert other.plans.loading("own.toml") == ["mine"]
    assert (other.plans.source("mine").parent / "own.toml").read_text("utf-8") == CONTROLLER


def test_who_replaces_a_plan_replaces_what_they_looked_at(one: _Here, other: _Here) -> None:
    one.plans.give("short", SHORT, "anna")
    one.plans.give("short", SHORT + "# again\n", "anna")
    looked = other.files.text("short")
    one.plans.give("short", SHORT + "# once more\n", "anna")
    with pytest.raises(NameTakenError, match="is already used for other content, given by anna") as refused:
        other.files.give("short", SHORT + "# other\n", "bert", instead_of=looked)
    assert refused.value.where == "short"
    assert other.plans.text("short") == SHORT + "# once more\n"


def test_folders_of_an_earlier_version_become_rows_once(one: _Here, other: _Here) -> None:
    model = shipped("three_inertia.toml").read_text("utf-8")
    for here in (one, other):
        here.lay("models/axle.toml", model)
        here.lay("plans/own.toml", CONTROLLER)
        here.lay("plans/mine.yaml", MINE)
        assert here.take_in() == []
        assert not (here.folder / "plans").exists()
        assert not (here.folder / "models").exists()
    assert one.plans.text("mine") == MINE
    assert one.models.path("axle").read_text("utf-8") == model
    given = [entry.target for entry in one.log.newest(100, 10) if entry.action.endswith("given")]
    assert sorted(given) == ["axle", "mine", "own"]


def test_what_the_database_has_otherwise_stays_and_is_told(one: _Here, other: _Here) -> None:
    one.controllers.give("own", CONTROLLER, "anna")
    one.plans.give("short", SHORT, "anna")
    one.plans.give("gone", SHORT.replace("name: short", "name: gone"), "anna")
    one.plans.remove("gone")
    laid = [
        other.lay("plans/own.toml", CONTROLLER + "# other\n"),
        other.lay("plans/gone.yaml", SHORT.replace("name: short", "name: gone")),
        other.lay("plans/mine.yaml", MINE),
        other.lay("plans/short.yaml", SHORT + "# other\n"),
        other.lay("plans/un fit.yaml", SHORT),
        other.lay("plans/unreadable.yaml", "name: [\n"),
        other.lay("plans/latin.toml", ""),
    ]
    laid[-1].write_bytes(b"\xff\x00")
    before = [path.read_bytes() for path in laid]
    for _ in range(2):
        told = {apart.file: apart.why for apart in other.take_in()}
        assert "another content under its name, given by anna" in told["plans/own.toml"]
        assert "another content under its name, given by anna" in told["plans/short.yaml"]
        assert "was removed" in told["plans/gone.yaml"]
        assert "loads own.toml, which stays too" in told["plans/mine.yaml"]
        assert set(told) == {f"plans/{path.name}" for path in laid}
        assert [path.read_bytes() for path in laid] == before
    assert other.controllers.path("own").read_text("utf-8") == CONTROLLER
    assert other.plans.text("mine") is None


def test_one_that_was_killed_before_a_file_was_removed_goes_on(one: _Here) -> None:
    one.plans.give("short", SHORT, "anna")
    path = one.lay("plans/short.yaml", SHORT)
    assert (one.take_in(), path.exists()) == ([], False)
