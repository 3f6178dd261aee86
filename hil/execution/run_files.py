"""The files of a run, in a folder of its own."""

from __future__ import annotations

from pathlib import Path

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
