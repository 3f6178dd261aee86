"""A file in pieces: what is added, what is refused, and that only a whole as it was sent takes its place."""

from __future__ import annotations

import hashlib
import resource
import signal
from pathlib import Path

import pytest

from hil.core.errors import BadInputError, BenchError
from hil.service.recordings._pieces import add_piece, size_of, take_whole


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def test_pieces_are_added_where_the_file_ends_and_nowhere_else(tmp_path: Path) -> None:
    path = tmp_path / "one/arriving"
    assert add_piece(path, "a.csv", 0, b"abc", sha256(b"abc"), 6) == 3
    assert add_piece(path, "a.csv", 0, b"abc", sha256(b"abc"), 6) == 3  # its answer went astray
    assert add_piece(path, "a.csv", 5, b"x", sha256(b"x"), 6) == 3  # one before it did
    assert add_piece(path, "a.csv", 3, b"def", sha256(b"def"), 6) == 6
    assert path.read_bytes() == b"abcdef"


def test_a_piece_that_is_damaged_or_too_long_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "arriving"
    add_piece(path, "a.csv", 0, b"abc", sha256(b"abc"), 4)
    with pytest.raises(BadInputError, match="SHA-256"):
        add_piece(path, "a.csv", 3, b"d", sha256(b"e"), 4)
    with pytest.raises(BadInputError, match="more than 4 bytes"):
        add_piece(path, "a.csv", 3, b"de", sha256(b"de"), 4)
    assert path.read_bytes() == b"abc"


def test_a_piece_that_the_disk_does_not_take_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "arriving"
    add_piece(path, "a.csv", 0, b"abc", sha256(b"abc"), 9000)
    piece = bytes(5000)
    before = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[0][1]))
        with pytest.raises(BenchError, match="cannot be written"):
            add_piece(path, "a.csv", 3, piece, sha256(piece), 9000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before[0])
        signal.signal(signal.SIGXFSZ, before[1])
    assert path.read_bytes() == b"abc"


def test_only_a_file_as_it_was_sent_takes_its_place(tmp_path: Path) -> None:
    arriving, place = tmp_path / "arriving", tmp_path / "results/a.csv"
    arriving.write_bytes(b"abcdef")
    assert not take_whole(arriving, sha256(b"abcdeg"), place)
    assert (size_of(arriving), place.exists()) == (0, False)
    arriving.write_bytes(b"abcdef")
    assert take_whole(arriving, sha256(b"abcdef"), place)
    assert take_whole(arriving, sha256(b"abcdef"), place)  # whoever did so was killed before saying it
    assert (place.read_bytes(), arriving.exists()) == (b"abcdef", False)
