"""Where the runs of pytest go: a numbered folder for each; a second session finds room beside the first.

It imports next to nothing, as the plugin that uses it does.
"""

from __future__ import annotations

import contextlib
from pathlib import Path


class Folders:
    """Numbered folders below a place: a new one for each run, or with `overwrite` the earlier ones."""

    def __init__(self, place: Path, *, overwrite: bool) -> None:
        self._place, self.overwrite = place, overwrite
        self._count = 0

    def next(self, name: str) -> Path:
        """The next run's folder: NAME-001 and so on; without `overwrite` it is made, as no one else's."""
        while True:
            self._count += 1
            folder = self._place / f"{name}-{self._count:03d}"
            if self.overwrite:
                return folder
            try:
                folder.mkdir(parents=True)
            except FileExistsError:
                continue  # of an earlier session, or of one beside this
            return folder


def leave_if_empty(folder: Path) -> None:
    """Remove the folder of a run that did not begin."""
    with contextlib.suppress(OSError):  # it holds something, or is not there
        folder.rmdir()


def folder_name(node: str) -> str:
    """A test's id as the name of a folder."""
    return "".join(character if character.isalnum() else "_" for character in node).strip("_")[-120:]
