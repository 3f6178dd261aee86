"""Recordings: what was measured, in memory and on disk (docs/reference/recordings.md)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.recording._mcap_reader import read_frames, read_mcap
from hil.core.recording._mcap_writer import RecordingWriter
from hil.core.recording._table import Event, Recording, checked
from hil.core.recording._tables_on_disk import (
    read_csv,
    read_mdf,
    read_parquet,
    write_csv,
    write_mdf,
    write_parquet,
)

#: Prefix of the metadata records that hold a run's segments, written as each begins.
SEGMENT = "segment/"

_READERS: dict[str, Callable[[Path], Recording]] = {
    ".mcap": read_mcap,
    ".csv": read_csv,
    ".parquet": read_parquet,
    ".mf4": read_mdf,
}
_WRITERS: dict[str, Callable[[Recording, Path], None]] = {
    ".csv": write_csv,
    ".parquet": write_parquet,
    ".mf4": write_mdf,
}


def read_recording(path: Path, *, least_samples: int = 2, allow_missing: bool = False) -> Recording:
    """Read `.mcap`, `.csv`, `.parquet` or `.mf4`; refuse what no command could use.

    Args:
        allow_missing: keep channels of which much is missing, for reports of runs that failed.

    Raises:
        BadInputError: names file, line and column where it can.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise BadInputError(
            f"recordings end in {', '.join(_READERS)}", where=str(path), fix="rename or convert the file"
        )
    return checked(reader(path), least_samples=least_samples, allow_missing=allow_missing)


def write_recording(recording: Recording, path: Path) -> None:
    """Write `.csv`, `.parquet` or `.mf4`, whole or not at all."""
    writer = _WRITERS.get(path.suffix.lower())
    if writer is None:
        raise BadInputError(f"an export ends in {', '.join(_WRITERS)}", where=str(path))
    writer(recording, path)


__all__ = [
    "SEGMENT",
    "Event",
    "Recording",
    "RecordingWriter",
    "checked",
    "read_frames",
    "read_recording",
    "write_recording",
]
