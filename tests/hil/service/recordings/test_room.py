"""How much room recordings may take: in bytes, in number, of a person, and on the disk."""

from __future__ import annotations

import datetime
import shutil
from pathlib import Path

import pytest

from hil.api_schemas.recording import RecordingData, RecordingState
from hil.core.errors import BadInputError
from hil.service.recordings import Room


def recording(number: int, size: int, state: RecordingState = "ready", by: str = "anna") -> RecordingData:
    at = datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC)
    received = size if state == "ready" else 0
    return RecordingData(
        id=number,
        name="a.csv",
        size=size,
        received=received,
        state=state,
        columns=[],
        given_by=by,
        given_at=at,
    )


def test_what_arrives_counts_with_its_whole_size(tmp_path: Path) -> None:
    room = Room(most_bytes=100, left_bytes=0)
    there = [recording(1, 30), recording(2, 50, "arriving")]
    room.refuse_too_much(20, "anna", "b.csv", there, tmp_path)
    with pytest.raises(BadInputError, match="0.0 of 0 MB are left") as refused:
        room.refuse_too_much(21, "anna", "b.csv", there, tmp_path)
    assert "--recordings-gb" in refused.value.fix


def test_there_are_not_too_many_and_not_too_many_of_a_person_arrive(tmp_path: Path) -> None:
    arriving = [recording(number, 1, "arriving") for number in (1, 2)]
    room = Room(most_count=3, most_arriving=2, left_bytes=0)
    room.refuse_too_much(1, "ben", "b.csv", arriving, tmp_path)
    with pytest.raises(BadInputError, match="2 recordings of anna are still arriving"):
        room.refuse_too_much(1, "anna", "b.csv", arriving, tmp_path)
    with pytest.raises(BadInputError, match="there are 3 recordings already"):
        room.refuse_too_much(1, "ben", "b.csv", [*arriving, recording(3, 1)], tmp_path)


def test_the_disk_keeps_room_for_runs(tmp_path: Path) -> None:
    free = shutil.disk_usage(tmp_path).free
    with pytest.raises(BadInputError, match="the disk has 0.0 MB for recordings"):
        Room(left_bytes=2.0 * free).refuse_too_much(1, "anna", "b.csv", [], tmp_path)
    room, there = Room(most_bytes=1e18, left_bytes=0), [recording(1, free // 2 + 10**9, "arriving")]
    with pytest.raises(BadInputError, match="for recordings"):
        room.refuse_too_much(free // 2, "anna", "b.csv", there, tmp_path)
