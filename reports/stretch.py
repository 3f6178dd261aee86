"""A stretch of one channel, ready to be drawn or transformed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.channels import TIME
from hil.core.recording import BLOCK, Recording
from reports.decimation import break_at_gaps, envelope
from reports.figure import Trace
from reports.labels import Label

Array = npt.NDArray[np.float64]
Lines = dict[str, tuple[Array, Array]]

#: Samples beyond which a figure of the whole recording is drawn from fewer, read in one pass: about what is
#: held in memory, some eight minutes at 1 kHz.
LONGEST_DRAWN = 1 << 19
_POINTS = 1 << 15  # many times what paper or screen can show


def cut(recording: Recording, name: str, start_s: float, end_s: float) -> tuple[Array, Array] | None:
    """Time (s) and values of channel `name` in start_s <= time_s <= end_s.

    None if the channel is missing, or has fewer than two finite values there.
    """
    if name not in recording or TIME not in recording:
        return None
    if not (np.isfinite(start_s) and np.isfinite(end_s)) or recording.samples < 2:
        return None
    grace = 0.5 * recording.sample_time_s
    first, last = recording.rows_before(start_s - grace), recording.rows_before(end_s + grace, or_at=True)
    rows = recording.rows(first, last, (TIME, name))
    if np.isfinite(rows[name]).sum() < 2:
        return None
    return rows[TIME], rows[name]


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


def thinned(recording: Recording) -> Lines:
    """Every channel of a long recording over its time, as few samples as show its peaks and gaps.

    Empty if the recording is short enough to be drawn as it is. It is read once, block by block.
    """
    if recording.samples <= LONGEST_DRAWN or TIME not in recording:
        return {}
    names = [name for name in recording.channels if name != TIME]
    points = max(2, _POINTS * BLOCK // recording.samples)
    parts: dict[str, list[tuple[Array, Array]]] = {name: [] for name in names}
    before = {name: np.zeros(0) for name in (TIME, *names)}  # the last sample: a gap may lie between blocks
    for _, rows in recording.blocks((TIME, *names)):
        block = {name: np.concatenate([before[name], rows[name]]) for name in rows}
        before = {name: values[-1:] for name, values in rows.items()}
        for name in names:
            parts[name].append(envelope(*break_at_gaps(*_measured(block[TIME], block[name])), points))
    return {
        name: (np.concatenate([x for x, _ in lines]), np.concatenate([y for _, y in lines]))
        for name, lines in parts.items()
    }


def _measured(times: Array, values: Array) -> tuple[Array, Array]:
    """The samples of a device that is slower than the rows: what lies between them is no gap."""
    there = np.isfinite(values)
    beside = np.concatenate([[False], there[:-1]]) | np.concatenate([there[1:], [False]])
    alone = np.count_nonzero(there & ~beside)
    return (times[there], values[there]) if 2 * alone > np.count_nonzero(there) else (times, values)
