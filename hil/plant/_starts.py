"""Where a replay begins: what first samples show, and within their noise what the next seconds tell.

A speed read from twenty samples is off by a quarter of their noise. Without drag a replay keeps that offset
to its end, which no model is to blame for.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

SECONDS = 4.0
"""Of a recording from its beginning, by which its start is found."""
_SAMPLES = (20, 10, 5)  # at first, as many as show no motion beyond their noise
_SURE = 4.0  # standard errors of the first samples' mean that a start may lie away from it
_ROUNDS = 2  # outputs change nearly linearly with a start
_STEP = 1e-3  # of a channel's rms, for derivatives


def beginning(values: Array) -> tuple[float, float]:
    """What a channel shows at first, and the standard error of that; NaN where it was not recorded."""
    if not np.isfinite(values[0]):
        return float("nan"), float("nan")
    for count in _SAMPLES:
        head = values[:count]
        noise = white_noise(head)
        if np.std(head) <= 1.5 * noise:
            return float(np.mean(head)), float(noise / np.sqrt(len(head)))
    return float(values[0]), white_noise(values[: _SAMPLES[0]])


def white_noise(values: Array) -> float:
    """Standard deviation of noise: it scatters as much from sample to sample as around its mean."""
    return float(np.median(np.abs(np.diff(values))) / (0.6745 * np.sqrt(2.0))) if len(values) > 1 else 0.0


def settled(
    first: Array, errors: Array, carried: Array, measured: Array, show: Callable[[Array], Array]
) -> Array:
    """Motor speed, wheel speed (rad/s) and shaft torque (N m) that suit the beginning of a recording best.

    Args:
        first: (3,), what first samples show; a channel that was not recorded follows from others.
        errors: (3,), standard errors of that.
        carried: (3,), what a torque that nobody recorded may have added before the first sample.
        measured: n x 3, NaN where a channel was not recorded.
        show: gives the outputs (n x 3) from a start.
    """
    reach = _SURE * errors + carried
    there = np.isfinite(measured[0])
    if not there.any() or not np.any(reach > 0.0):
        return first
    size = np.sqrt(np.mean(np.where(there, measured, 0.0) ** 2, axis=0))
    noise = np.array([white_noise(one) for one in measured.T])
    weight = np.where(there, 1.0 / np.maximum(np.nan_to_num(noise), 1e-6 * np.maximum(size, 1e-9)), 0.0)
    steps = np.maximum(_STEP * np.where(size > 0.0, size, 1.0), 1e-9)

    def away(start: Array) -> Array:
        error = np.where(there, measured - show(start), 0.0) * weight
        return np.asarray(np.nan_to_num(error, nan=1e12).ravel(), dtype=float)

    return _least(first, reach, steps, away)


def _least(first: Array, reach: Array, steps: Array, away: Callable[[Array], Array]) -> Array:
    """The start within reach of the first one that leaves least, by Gauss and Newton's steps."""
    from scipy.optimize import lsq_linear

    free = np.flatnonzero(reach > 0.0)
    start, left = first.astype(float), away(first)
    for _ in range(_ROUNDS):
        slopes = np.stack([(away(start + one) - left) / one.sum() for one in np.diag(steps)[free]])
        low, high = ((first + sign * reach - start)[free] for sign in (-1.0, 1.0))
        moves = lsq_linear(slopes.T, -left, bounds=(np.minimum(low, -1e-12), np.maximum(high, 1e-12))).x
        trial = start.copy()
        trial[free] += moves
        after = away(trial)
        if not after @ after < left @ left:
            break
        start, left = trial, after
    return start
