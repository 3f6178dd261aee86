"""Numbers as JSON has them: what is no number is null."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_DIGITS = 6


def number(value: float | None) -> float | None:
    """A number as it is, null for what is none."""
    return None if value is None or not np.isfinite(value) else float(value)


def numbers(values: npt.ArrayLike) -> list[float | None]:
    """To be drawn, so six digits are enough."""
    return [
        None if not np.isfinite(one) else float(f"{one:.{_DIGITS}g}")
        for one in np.asarray(values, float).tolist()
    ]


def envelope(time: Array, values: Array, from_s: float, width_s: float, count: int) -> tuple[Array, Array]:
    """Lowest and highest value in equal buckets from `from_s`; NaN where nothing was measured."""
    bucket = np.floor((time - from_s) / width_s + 1e-6).astype(np.int64)
    inside = (bucket >= 0) & (bucket < count)
    bucket, values = bucket[inside], values[inside]
    low, high = np.full(count, np.nan), np.full(count, np.nan)
    if len(bucket):
        starts = np.flatnonzero(np.diff(bucket, prepend=-1))
        low[bucket[starts]] = np.fmin.reduceat(values, starts)
        high[bucket[starts]] = np.fmax.reduceat(values, starts)
    return low, high
