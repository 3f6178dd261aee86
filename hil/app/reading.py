"""What was understood of recordings that other tools made: their columns, and what was assumed of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from hil.core.recording import Recording, columns_of


def reading_of(recordings: Iterable[Recording]) -> dict[str, Any]:
    """By file, for `--json`: `columns` by channel, and `notes`, a sentence each; only files with either."""
    found: dict[str, Any] = {}
    for recording in recordings:
        columns, notes = columns_of(recording), list(dict.fromkeys(recording.notes))
        if columns or notes:
            found[str(recording.source)] = {"columns": columns, "notes": notes}
    return found


def reading_in_words(reading: Mapping[str, Any]) -> list[str]:
    """The same for people, a line each."""
    return [f"note: {path}: {note}" for path, read in reading.items() for note in read["notes"]]
