"""Studies and campaigns of services that share a database: listed by all, their files kept for all."""

from __future__ import annotations

import asyncio
import datetime
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import Engine

from hil.api_schemas.study import STUDY_OVER, StudyData
from hil.service.archive import Archive, ArchiveAwayError
from hil.service.jobs.job_repository import JobRepository, files_in_results
from hil.service.jobs.shared_results import SharedResults
from hil.service.store import ResultStore


class _Here:
    """Studies of a service, without what carries them out."""

    def __init__(self, folder: Path, engine: Engine, archive: Path | None) -> None:
        self._folder, self._engine, self._archive = folder, engine, archive
        self.begin()

    def begin(self) -> None:
        """As a service begins in its folder, again or first."""
        store = ResultStore(self._engine, self._folder.name, f"that of {self._folder.name}")
        archive = None if self._archive is None else Archive(str(self._archive))
        self.shared = SharedResults(store, "study", StudyData, archive, self._folder / "elsewhere/studies")
        self.records = JobRepository(self._folder / "studies", "study.json", StudyData, self.shared.draw)

    def own(self) -> list[StudyData]:
        files = {one.id: files_in_results(self.results(one.id)) for one in self.records}
        return [one.model_copy(update={"files": files[one.id]}) for one in self.records]

    def to_tell(self) -> list[StudyData]:
        return list(self.records)

    def is_over(self, one: StudyData) -> bool:
        return one.state in STUDY_OVER

    def is_removed(self, number: int) -> bool:
        return self.records.is_removed(number)

    def results(self, number: int) -> Path:
        return self.records.folder_of(number) / "results"

    def ended(self, **files: str) -> int:
        """One that is over, with files of a stem and a text each."""
        number = self.records.take_number()
        self.keep(number)
        self.results(number).mkdir()
        for stem, text in files.items():
            (self.results(number) / f"{stem}.txt").write_text(text)
        return number

    def keep(self, number: int, state: str = "ended") -> None:
        now = datetime.datetime.now(datetime.UTC)
        study = StudyData(
            id=number, kind="diagnosis", state=state, runs=[1], requested_by="anna", asked_at=now
        )  # fmt: skip
        self.records.keep(study)

    def share(self) -> str:
        return asyncio.run(self.shared.share(self))

    def other(self, number: int) -> StudyData:
        found = self.shared.other(number)
        assert found is not None
        return found

    def brought(self, number: int, name: str) -> str:
        return asyncio.run(self.shared.bring(number, name)).read_text()


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    return tmp_path / "archive"


@pytest.fixture
def one(tmp_path: Path, engine: Engine, archive: Path) -> _Here:
    return _Here(tmp_path / "one", engine, archive)


@pytest.fixture
def two(tmp_path: Path, engine: Engine, archive: Path) -> _Here:
    return _Here(tmp_path / "two", engine, archive)


def test_no_number_is_given_twice(engine: Engine) -> None:
    stores = [ResultStore(engine, name, "") for name in ("one", "two")]
    with ThreadPoolExecutor(8) as several:
        drawn = [several.submit(stores[turn % 2].draw, "study", 0) for turn in range(24)]
    assert sorted(one.result() for one in drawn) == list(range(1, 25))
    assert (stores[0].draw("study", 90), stores[1].draw("study", 3)) == (91, 92)
    assert stores[0].draw("campaign", 0) == 1


def test_what_one_service_has_others_list_and_read(one: _Here, two: _Here, archive: Path) -> None:
    first, second = one.ended(report="seen", model="x = 1"), two.ended(report="other")
    assert (first, second) == (1, 2)
    assert (one.share(), two.share()) == ("", "")
    (found,) = two.shared.others()
    assert (found.id, found.place, found.files) == (1, "that of one", ["model.txt", "report.txt"])
    assert [told.id for told in one.shared.others()] == [2]
    assert (archive / "studies/000001/report.txt").read_text() == "seen"
    assert two.brought(1, "report.txt") == "seen"
    assert sorted(path.name for path in asyncio.run(two.shared.bring_all(1)).iterdir()) == found.files
    assert (one.shared.other(1), two.shared.other(2), two.shared.other(3)) == (None, None, None)
    with pytest.raises(ArchiveAwayError, match="no such file"):
        two.brought(1, "none.txt")
    (archive / "studies/000001/report.txt").write_text("SEEN")
    assert two.brought(1, "report.txt") == "seen", "what was brought is as it was kept"
    two.begin()
    with pytest.raises(ArchiveAwayError, match="differs from the one written"):
        two.brought(1, "report.txt")


def test_what_is_under_way_is_told_and_its_files_are_kept_once_it_is_over(one: _Here, two: _Here) -> None:
    number = one.ended(part="a")
    one.keep(number, "running")
    assert (one.share(), one.shared.waiting) == ("", 0)
    assert (two.other(number).state, two.other(number).files) == ("running", [])
    one.keep(number)
    one.share()
    assert (two.other(number).state, two.other(number).files) == ("ended", ["part.txt"])
    one.keep(number, "running")  # gone on with
    one.share()
    (one.results(number) / "part.txt").write_text("b")
    (one.results(number) / "more.txt").write_text("c")
    one.keep(number)
    one.share()
    assert [two.brought(number, name) for name in ("part.txt", "more.txt")] == ["b", "c"]
    (one.results(number) / "more.txt").unlink()
    one.keep(number, "failed")
    one.share()
    assert two.other(number).files == ["part.txt"]


def test_a_service_that_was_killed_goes_on_where_it_was(one: _Here, two: _Here, archive: Path) -> None:
    number = one.ended(report="seen")
    archive.write_text("no folder: the store cannot be reached")
    with pytest.raises(ArchiveAwayError):
        one.share()
    assert (one.shared.waiting, two.other(number).files) == (1, [])
    archive.unlink()
    one.begin()
    assert (one.share(), one.shared.waiting) == ("", 0)
    assert two.brought(number, "report.txt") == "seen"


def test_what_is_removed_is_removed_for_all_and_what_is_lost_is_not(
    one: _Here, two: _Here, archive: Path
) -> None:
    removed, lost = one.ended(report="a"), one.ended(report="b")
    one.share()
    one.records.remove(removed)
    one.begin()  # killed before it has said so
    one.share()
    assert [told.id for told in two.shared.others()] == [lost]
    assert [path.parent.name for path in archive.rglob("*.txt")] == [f"{lost:06d}"]
    for path in sorted((one.records.folder_of(lost)).rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    one.records.folder_of(lost).rmdir()
    one.begin()
    one.share()
    assert two.brought(lost, "report.txt") == "b"
    assert one.ended() == lost + 1


def test_without_a_store_others_are_told_where_the_files_are(tmp_path: Path, engine: Engine) -> None:
    one, two = (_Here(tmp_path / name, engine, None) for name in ("one", "two"))
    number = one.ended(report="seen")
    assert (one.share(), one.shared.waiting) == ("", 0)
    assert (two.other(number).place, two.other(number).files) == ("that of one", [])
    with pytest.raises(ArchiveAwayError):
        two.brought(number, "report.txt")
    one.records.remove(number)
    one.share()
    assert two.shared.others() == []


def test_a_number_of_an_earlier_version_that_two_have_stays_with_each(one: _Here, two: _Here) -> None:
    one.keep(1)
    two.keep(1)
    two.keep(2)
    assert (one.share(), two.share()) == ("", "")
    assert two.shared.others() == [one.own()[0].model_copy(update={"place": "that of one"})]
    assert [(told.id, told.place) for told in one.shared.with_others(one.own())] == [
        (2, "that of two"),
        (1, ""),
    ]
    assert [(told.id, told.place) for told in two.shared.with_others(two.own())] == [(2, ""), (1, "")]
    two.begin()
    assert two.records.take_number() == 3, "above what is in its folder"
    one.begin()
    assert one.records.take_number() == 4
