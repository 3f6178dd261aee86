"""A stretch of one channel, ready to be drawn or transformed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.channels import TIME
from hil.core.recording import Recording
from reports.envelope import break_at_gaps
from reports.figure import Trace
from reports.labels import Label

Array = npt.NDArray[np.float64]


def cut(recording: Recording, name: str, start_s: float, end_s: float) -> tuple[Array, Array] | None:
    """Time (s) and values of channel `name` in start_s <= time_s <= end_s.

    None if the channel is missing, or has fewer than two finite values there.
    """
    if name not in recording or TIME not in recording:
        return None
    time = recording.time_s
    if not (np.isfinite(start_s) and np.isfinite(end_s)) or len(time) < 2:
        return None
    grace = 0.5 * recording.sample_time_s
    first = int(np.searchsorted(time, start_s - grace, "left"))
    last = int(np.searchsorted(time, end_s + grace, "right"))
    values = recording[name][first:last]
    if np.isfinite(values).sum() < 2:
        return None
    return time[first:last], values


def line(
    recording: Recording,
    name: str,
    label: Label,
    role: str,
    *,
    start_s: float,
    end_s: float,
    zero_s: float = 0.0,
    dash: str = "solid",
) -> Trace | None:
    """The stretch as a line over the time from `zero_s`; None as in `cut`."""
    found = cut(recording, name, start_s, end_s)
    if found is None:
        return None
    x, y = break_at_gaps(*_measured(found[0] - zero_s, found[1]))
    return Trace(label, x, y, role, dash)


def _measured(times: Array, values: Array) -> tuple[Array, Array]:
    """The samples of a device that is slower than the rows: what lies between them is no gap."""
    there = np.isfinite(values)
    beside = np.concatenate([[False], there[:-1]]) | np.concatenate([there[1:], [False]])
    alone = np.count_nonzero(there & ~beside)
    return (times[there], values[there]) if 2 * alone > np.count_nonzero(there) else (times, values)
