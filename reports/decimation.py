"""Fewer points of a line that look the same: the lowest and highest sample of each stretch are kept."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

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
