"""Where a plan's segments lie in a log: from the run's own recording, or as a person says."""

from __future__ import annotations

import datetime
import json
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.recording import read_as_written, run_of
from hil.core.result import Segment

_FIX = (
    'give the recording.mcap of the run, or {"segments": [{"id": …, "start_s": …, "step_s": …, "end_s": …}]} '
    "with times of the replayed recording"
)
_LIST = TypeAdapter(list[Segment])


@dataclass(frozen=True)
class Segments:
    """Segments, and when their times count from: ns since 1970; None: from the replay's first row."""

    segments: tuple[Segment, ...]
    row_0_ns: int | None = None

    def on(self, row_0_ns: int) -> tuple[Segment, ...]:
        """With times from another moment."""
        if self.row_0_ns is None:
            return self.segments
        later_s = (self.row_0_ns - row_0_ns) * 1e-9
        return tuple(
            segment.model_copy(
                update={
                    key: round(getattr(segment, key) + later_s, 6)
                    for key in ("start_s", "step_s", "end_s", "first_change_s")
                    if getattr(segment, key) is not None
                }
            )
            for segment in self.segments
        )


def segments_from(path: Path) -> Segments:
    """Segments of a run's recording, or of a JSON file.

    Raises:
        BadInputError: it has none, or cannot be understood.
    """
    if path.suffix.lower() == ".mcap":
        return _of_recording(path)
    try:
        data = json.loads(read_text(path))
        found = _LIST.validate_python(data["segments"] if isinstance(data, dict) else data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise BadInputError(f"segments: {place}: {first['msg']}", where=str(path), fix=_FIX) from error
    except (ValueError, KeyError, RecursionError) as error:
        raise BadInputError("has no segments", where=str(path), fix=_FIX) from error
    for segment in found:
        if not segment.start_s <= segment.step_s <= segment.end_s:
            raise BadInputError(
                f"segment '{segment.id}' does not satisfy start_s <= step_s < end_s",
                where=str(path),
                fix=_FIX,
            )
    return Segments(tuple(found))


def _of_recording(path: Path) -> Segments:
    recording = read_as_written(path)
    run = run_of(recording)
    if run is None or not run.segments:
        raise BadInputError("has no segments: it is not the recording of a run", where=str(path), fix=_FIX)
    table = recording.metadata.get("time", {})
    try:
        began_ns = moment_ns(table["bench_clock_0_at"])
        row_0_ns = began_ns + round(1e9 * float(table["bench_clock_at_row_0_s"]))
    except (KeyError, ValueError) as error:
        raise BadInputError("has no date", where=str(path), fix=_FIX) from error
    return Segments(run.segments, row_0_ns)


def moment_ns(text: str) -> int:
    """ISO 8601 as ns since 1970, to the millisecond.

    Raises:
        ValueError: it is no moment.
    """
    return round(datetime.datetime.fromisoformat(text).timestamp() * 1e3) * 1_000_000
