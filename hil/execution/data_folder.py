"""Where a service or an agent keeps its data: its folder, files of runs, files that plans load."""

from __future__ import annotations

import contextlib
import secrets
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel

from hil.core.errors import BadInputError
from hil.core.files import make_directory, read_text, write_atomically
from hil.core.files.locks import HeldError, lock_on
from test_plans import Plan

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


#: Locked from before a run's process begins until it has ended, whoever has ended it.
LOCK = "run.lock"


def folder_of(folder: Path, run: int) -> Path:
    """Where the files of a run are, below the folder of all runs."""
    return folder / f"{run:06d}"


def files_in(folder: Path) -> list[Path]:
    """What a run has left for others, by name."""
    if not folder.is_dir():
        return []
    hidden = (".", LOCK)
    return sorted(
        path
        for path in folder.iterdir()
        if not path.name.startswith(hidden) and path.is_file() and not path.is_symlink()
    )


def files_of(value: object) -> Iterator[Path]:
    """All files that a plan's steps name, also steps within steps."""
    if isinstance(value, Path):
        yield value
    elif isinstance(value, Plan):
        yield from files_of((value.steps, value.finally_))
    elif isinstance(value, BaseModel):
        for name in type(value).model_fields:
            yield from files_of(getattr(value, name))
    elif isinstance(value, list | tuple):
        for one in value:
            yield from files_of(one)
    elif isinstance(value, dict):
        yield from files_of(list(value.values()))
