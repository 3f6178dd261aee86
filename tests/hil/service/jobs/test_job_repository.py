"""What is had by number: removed with its files, and a number means one thing for ever."""

from __future__ import annotations

import datetime
from pathlib import Path

import pytest

from hil.api_schemas.study import StudyData
from hil.service.jobs.job_repository import JobRepository


def studies(folder: Path) -> JobRepository[StudyData]:
    return JobRepository(folder, "study.json", StudyData)


@pytest.fixture
def two(tmp_path: Path) -> JobRepository[StudyData]:
    """The second has results."""
    found = studies(tmp_path)
    now = datetime.datetime.now(datetime.UTC)
    for number in (found.take_number(), found.take_number()):
        found.keep(
            StudyData(
                id=number,
                kind="diagnosis",
                state="ended",
                runs=[1],
                model="m",
                requested_by="x",
                asked_at=now,
            )
        )
    results = found.folder_of(2) / "results"
    (results / "inside").mkdir(parents=True)
    (results / "report.html").write_text("seen")
    (results / "inside/more.json").write_text("{}")
    (found.folder_of(2) / "process").write_text("12")
    return found


def test_what_is_removed_leaves_nothing_but_its_number(two: JobRepository[StudyData], tmp_path: Path) -> None:
    two.remove(2)
    assert ([one.id for one in two], two.get(2)) == ([1], None)
    assert list(two.folder_of(2).iterdir()) == []
    assert two.take_number() == 3
    again = studies(tmp_path)
    assert ([one.id for one in again], again.take_number()) == ([1], 3)


def test_a_removal_that_was_cut_off_is_finished_at_the_next_beginning(
    two: JobRepository[StudyData], tmp_path: Path
) -> None:
    (two.folder_of(2) / "study.json").unlink()
    again = studies(tmp_path)
    assert [one.id for one in again] == [1]
    assert list(two.folder_of(2).iterdir()) == []


def test_one_that_cannot_be_read_keeps_its_files(two: JobRepository[StudyData], tmp_path: Path) -> None:
    (two.folder_of(2) / "study.json").write_text("{")
    assert [one.id for one in studies(tmp_path)] == [1]
    assert (two.folder_of(2) / "results/report.html").read_text() == "seen"


def test_a_link_is_removed_and_not_what_it_names(two: JobRepository[StudyData], tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "kept").write_text("kept")
    (two.folder_of(2) / "link").symlink_to(elsewhere)
    two.remove(2)
    assert (elsewhere / "kept").read_text() == "kept"


def test_what_is_no_folder_of_one_is_left_alone(two: JobRepository[StudyData], tmp_path: Path) -> None:
    (tmp_path / "000009").write_text("a file")
    (tmp_path / "000012-copy").mkdir()
    (tmp_path / "000012-copy/mine").write_text("kept")
    again = studies(tmp_path)
    assert ([one.id for one in again], again.take_number()) == ([2, 1], 3)
    assert (tmp_path / "000012-copy/mine").read_text() == "kept"
