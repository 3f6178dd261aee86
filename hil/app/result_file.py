"""JSON that commands write: results with their files and what proves them, and how columns were read."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from hil.core.files import sha256_of, write_atomically
from hil.core.recording import Recording, columns_of
from hil.core.result import RunResult


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


RESULT = "result.json"
F = TypeVar("F")


@dataclass(frozen=True)
class Outcome(Generic[F]):
    """What an analysis came to.

    Attributes:
        found: what was computed.
        summary: the content of its JSON file.
        folder: where that file lies, beside all others.
    """

    found: F
    summary: dict[str, Any]
    folder: Path


def to_json(value: Mapping[str, Any], *, ascii_only: bool = False) -> str:
    """JSON with two spaces of indent, without a line end; infinities and NaN become null."""
    return json.dumps(_plain(value), indent=2, ensure_ascii=ascii_only, allow_nan=False)


def json_file(value: Mapping[str, Any]) -> bytes:
    """The content of a JSON file."""
    return (to_json(value) + "\n").encode()


def write_result(
    result: RunResult, recording: Recording, files: Mapping[str, str], folder: Path
) -> RunResult:
    """Write the result with the SHA-256 of each file; as it is written.

    Args:
        files: names of files in the folder by kind; one that does not exist has no hash.

    Raises:
        HilError: it cannot be written.
    """
    there = [name for name in dict.fromkeys(files.values()) if (folder / name).is_file()]
    proven = result.model_copy(
        update={
            "files": dict(files),
            "sha256": {name: sha256_of(folder / name) for name in there},
            "samples_sha256": recording.samples_sha256,
        }
    )
    write_atomically(folder / RESULT, text_of(proven))
    return proven


def text_of(result: RunResult) -> str:
    """The file's text."""
    return result.model_dump_json(indent=2) + "\n"


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
