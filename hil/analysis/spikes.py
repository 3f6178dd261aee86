"""Single readings that no axle gives: a glitch of a sensor, a bit that fell over on a bus."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

SPIKES = 20
"""Readings of a channel that are left out at most; more are what it does."""
_RANGES = 3.0  # of that of 98 % of the readings: one that jumps further and back is a glitch


def without_spikes(values: Array, channel: str, dt: float) -> tuple[Array, str]:
    """Readings with the mean of its neighbours for each that jumps far away and back, and what to say of it.

    Far is several times the range in which nearly all readings lie. Where many jump so, it is what the
    channel does: nothing is changed, and there is nothing to say.
    """
    change = np.diff(values)
    away, back = change[:-1], change[1:]
    low, high = np.quantile(values, (0.01, 0.99))
    far = np.minimum(np.abs(away), np.abs(back)) > _RANGES * (high - low)
    at = 1 + np.flatnonzero(far & (away * back < 0.0)) if high > low else np.zeros(0, dtype=int)
    if not 0 < at.size <= SPIKES:
        return values, ""
    mended = values.copy()
    mended[at] = 0.5 * (values[at - 1] + values[at + 1])
    first = f"{values[at[0]]:.4g} at {at[0] * dt:.4g} s"
    text = (
        f"a single reading of {first}"
        if at.size == 1
        else f"{at.size} single readings, the first of {first},"
    )
    return mended, f"{text} in {channel} omitted: no axle can move so far and back in a sample"
