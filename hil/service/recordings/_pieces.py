"""A file that comes in pieces: each is checked before it is added, and the whole before it is anything."""

from __future__ import annotations

import contextlib
import hashlib
import os
from pathlib import Path

from hil.core.errors import BadInputError, BenchError
from hil.core.files import full_disk_in_words, make_directory, sha256_of


def add_piece(path: Path, name: str, at: int, piece: bytes, sha256: str, size: int) -> int:
    """Add a piece if it begins where the file ends; how much of the file is there.

    Args:
        name: of the file, for messages.
        size: of the whole file.

    Raises:
        BadInputError: the piece is not what its SHA-256 says, or goes beyond the file's end.
        BenchError: it cannot be written; the file is as it was.
    """
    there = size_of(path)
    if at != there or not piece:
        return there
    if hashlib.sha256(piece).hexdigest() != sha256:
        raise BadInputError("the piece is not what its SHA-256 says", where=name, fix="send it again")
    if there + len(piece) > size:
        raise BadInputError(f"the file has more than {size} bytes", where=name, fix="give it anew")
    try:
        make_directory(path.parent)
        with path.open("ab", buffering=0) as file:
            left = memoryview(piece)
            while left:
                left = left[file.write(left) :]
    except OSError as error:
        with contextlib.suppress(OSError):
            os.truncate(path, there)
        what = f"cannot be written: {full_disk_in_words(error, path)}"
        raise BenchError(what, where=name, fix="free disk space, then send it again") from error
    return there + len(piece)


def size_of(path: Path) -> int:
    """Bytes of the file that are there."""
    try:
        return path.stat().st_size
    except OSError:
        return 0


def take_whole(path: Path, sha256: str, place: Path) -> bool:
    """Put a file that is whole on the disk and into its place; false if it is not what its SHA-256 says.

    One that is in its place already stays there.

    Raises:
        OSError: the disk failed.
    """
    if not path.exists() and place.exists():
        return sha256_of(place) == sha256
    if sha256_of(path) != sha256:
        path.unlink()
        return False
    with path.open("rb") as file:
        os.fsync(file.fileno())
    make_directory(place.parent)
    path.replace(place)
    return True
