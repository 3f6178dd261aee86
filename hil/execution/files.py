"""Files of a run in a folder of its own, and those that a plan loads."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel

from test_plans import Plan

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
