"""Raw frames of a recording of the project's own."""

from __future__ import annotations

import contextlib
import datetime
from pathlib import Path

from hil.core.can_logs._log import CanLog, ordered
from hil.core.recording import read_as_written, read_frames


def read_own(path: Path) -> CanLog:
    """The frames of each bus; the bench clock is that of their stamps."""
    recording = read_as_written(path)
    began_ns = None
    with contextlib.suppress(KeyError, ValueError):
        moment = datetime.datetime.fromisoformat(recording.metadata["time"]["bench_clock_0_at"])
        began_ns = round(moment.timestamp() * 1e3) * 1_000_000
    frames = {bus: ordered(block) for bus, block in read_frames(path).items() if len(block)}
    return CanLog(path, frames, began_ns, remarks=tuple(recording.damage))
