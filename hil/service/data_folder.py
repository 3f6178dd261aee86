"""The folder of a service, or of an agent: one keeps its data there, under a name made once."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Iterator
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.files import make_directory, read_text, write_atomically
from hil.core.locks import HeldError, lock_on

_LONGEST = 40


@contextlib.contextmanager
def alone_in(folder: Path, *, who: str, fix: str) -> Iterator[None]:
    """Make the folder if it is not there, and let nobody else of `who` keep its data there meanwhile.

    Raises:
        BadInputError: somebody does, or the folder cannot be made.
    """
    make_directory(folder, option="--data")
    try:
        with lock_on(folder):
            yield
    except HeldError as error:
        raise BadInputError(
            f"another {who} keeps its data here: {error}", where=str(folder), fix=fix
        ) from None


def name_in(folder: Path, file: str) -> str:
    """128 random bits in hexadecimal: made once, and kept in a file of the folder."""
    path = folder / file
    if not path.is_file():
        write_atomically(path, secrets.token_hex(16))
    return read_text(path).strip()[:_LONGEST]
