"""The folder of a service, or of an agent: one keeps its data there, under a name made once."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Iterator
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import make_directory, read_text, write_atomically
from hil.core.files.locks import HeldError, lock_on

_LONGEST = 40


@contextlib.contextmanager
def alone_in(folder: Path, *, who: str, fix: str) -> Iterator[None]:
    """Make the folder if it is not there, and let no one else of `who` keep its data there meanwhile.

    Raises:
        BadInputError: somebody does, or the folder cannot be made.
    """
    make_private(folder)
    try:
        with lock_on(folder):
            yield
    except HeldError as error:
        raise BadInputError(
            f"another {who} keeps its data here: {error}", where=str(folder), fix=fix
        ) from None


def make_private(folder: Path) -> None:
    """Make the folder if it is not there; no one but its owner can read what is in it.

    Raises:
        BadInputError: it cannot be made, or is somebody else's.
    """
    make_directory(folder, option="--data")
    try:
        folder.chmod(0o700)
    except OSError as error:
        raise BadInputError(
            f"cannot be made its owner's alone: {error.strerror}",
            where=str(folder),
            fix="give a folder of your own with --data",
        ) from error


def name_in(folder: Path, file: str) -> str:
    """128 random bits in hexadecimal: made once, and kept in a file of the folder."""
    path = folder / file
    if not path.is_file():
        write_atomically(path, secrets.token_hex(16))
    return read_text(path).strip()[:_LONGEST]
