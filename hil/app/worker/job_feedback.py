"""What a job reports while it works, in a file beside its request: text, share done, and what was decided."""

from __future__ import annotations

import contextlib
import json
import time
from collections.abc import Iterator
from pathlib import Path

from hil.app.feedback import LoggedFeedback, Show
from hil.core.files import write_atomically

PROGRESS = "progress.json"
_EVERY_S = 0.5
_MOST_LINES = 200


class FileFeedback(LoggedFeedback):
    """Written anew twice a second at most; no one answers."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / PROGRESS
        self._written_s, self._text, self._share = 0.0, "", 0.0
        self._lines: list[str] = []

    @contextlib.contextmanager
    def progress(self, description: str) -> Iterator[Show]:
        """Keep each text with its share."""

        def show(text: str, share: float | None = None) -> None:
            self._text, self._share = f"{description}: {text}", share or 0.0
            if time.monotonic() - self._written_s > _EVERY_S:
                self._write()

        show("begins")
        yield show
        self._write()

    def note(self, text: str) -> None:
        """A line of the log."""
        super().note(text)
        self._line(text)

    def warn(self, text: str) -> None:
        """A line of the log."""
        super().warn(text)
        self._line(text)

    def _line(self, text: str) -> None:
        self._lines = [*self._lines, text][-_MOST_LINES:]
        self._write()

    def _write(self) -> None:
        found = {"text": self._text, "share": self._share, "lines": self._lines}
        write_atomically(self._path, json.dumps(found))
        self._written_s = time.monotonic()
