"""A stretch of one channel, ready to be drawn or transformed: cut, decimated, enveloped.

Decimation keeps the lowest and highest sample of each piece. Curves that swing so fast that the one drawn
last covers the others are drawn as envelopes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import TIME
from hil.core.recording import BLOCK, Recording
from reports.figure import Figure, Range, Trace
from reports.labels import Label

Array = npt.NDArray[np.float64]

#: A step in time this many times the usual one is a gap: no line is drawn across.
_GAP_FACTOR = 10.0


def break_at_gaps(x: Array, y: Array) -> tuple[Array, Array]:
    """`x`, `y` (1-D, same length) with a NaN in `y` wherever `x` jumps by ten usual steps or more."""
    if len(x) < 3:
        return x, y
    steps = np.diff(x)
    gaps = np.flatnonzero(steps > _GAP_FACTOR * np.median(steps)) + 1
    if not gaps.size:
        return x, y
    return np.insert(x, gaps, (x[gaps - 1] + x[gaps]) / 2), np.insert(y, gaps, np.nan)


def envelope(x: Array, y: Array, points: int, *, logarithmic: bool = False) -> tuple[Array, Array]:
    """At most about `points` of the samples of `y` over `x` (1-D, same length), peaks and gaps kept.

    Infinite values count as missing. A stretch without any finite value becomes one NaN: a gap.
    With `logarithmic`, stretches are equally long on a logarithmic x axis; `x` is positive, `y` finite.
    """
    if logarithmic and len(x) > points:
        return _logarithmic(x, y, points)
    y = np.where(np.isfinite(y), y, np.nan)
    count = len(y)
    if count <= points:
        return x, y
    stretch = -(-count // max(points // 2, 1))
    rows = -(-count // stretch)
    padded = np.full(rows * stretch, np.nan)
    padded[:count] = y
    table = padded.reshape(rows, stretch)
    missing = np.isnan(table)
    lowest = np.argmin(np.where(missing, np.inf, table), axis=1)
    highest = np.argmax(np.where(missing, -np.inf, table), axis=1)
    starts = np.arange(rows) * stretch
    kept = np.unique(np.concatenate([[0], starts + lowest, starts + highest, [count - 1]]))
    return x[kept], y[kept]


def _logarithmic(x: Array, y: Array, points: int) -> tuple[Array, Array]:
    edges = np.geomspace(x[0], x[-1], max(points // 2, 1) + 1)
    stretch = np.searchsorted(edges, x, "right")
    by_height = np.lexsort((y, stretch))  # within each stretch from the lowest to the highest
    last = np.flatnonzero(np.diff(stretch[by_height], append=stretch.max() + 1))
    first = np.concatenate([[0], last[:-1] + 1])
    kept = np.unique(np.concatenate([by_height[first], by_height[last]]))
    return x[kept], y[kept]


#: Stretches of the x axis, each with its lowest and highest value.
STRETCHES = 160
_BOTH_WAYS = 1.5  # length of the path over its height from which a stretch swings
_VISIBLE = 0.02  # of the figure's height: lower swings look like one line
_MANY = 0.25  # of the stretches


@dataclass(frozen=True)
class Outline:
    """Lowest and highest value of a trace in each stretch, over the middle of the stretch."""

    x: Array
    low: Array
    high: Array


def outlines(figure: Figure) -> dict[int, Outline]:
    """By the number of the trace what is drawn in its place; empty unless two or more cover each other."""
    if figure.logarithmic or figure.logarithmic_x or len(figure.traces) < 2:
        return {}
    spans = [(t.y[np.isfinite(t.y)].min(), t.y[np.isfinite(t.y)].max()) for t in figure.traces if _drawn(t)]
    if not spans:
        return {}
    height = max(high for _, high in spans) - min(low for low, _ in spans)
    found = {
        number: outline
        for number, trace in enumerate(figure.traces)
        if _drawn(trace) and (outline := _outline(trace, figure, height)) is not None
    }
    return found if len(found) > 1 else {}


def shown_x(figure: Figure, covering: dict[int, Outline]) -> Range | None:
    """The range of x; of envelopes that of their curves, which reach to the ends of the outer stretches."""
    if figure.x_range is not None or not covering:
        return figure.x_range
    curves = [figure.traces[number].x for number in covering]
    return min(float(x[0]) for x in curves), max(float(x[-1]) for x in curves)


def _drawn(trace: Trace) -> bool:
    return not trace.points and int(np.isfinite(trace.y).sum()) > 4 * STRETCHES


def _outline(trace: Trace, figure: Figure, height: float) -> Outline | None:
    """None of a trace that swings in few stretches only."""
    start, end = figure.x_range or (float(trace.x[0]), float(trace.x[-1]))
    there = np.isfinite(trace.y) & (trace.x >= start) & (trace.x <= end)
    x, y = trace.x[there], trace.y[there]
    if len(x) < 2:
        return None
    edges = np.linspace(start, end, STRETCHES + 1)
    first = np.unique(np.searchsorted(x, edges[:-1]))
    first = first[first < len(x)]
    low, high = np.minimum.reduceat(y, first), np.maximum.reduceat(y, first)
    path = np.add.reduceat(np.abs(np.diff(y, append=y[-1])), first)
    swings = (path > _BOTH_WAYS * (high - low)) & (high - low > _VISIBLE * height)
    if np.mean(swings) < _MANY:
        return None
    last = np.append(first[1:], len(x)) - 1
    return Outline((x[first] + x[last]) / 2, low, high)


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
