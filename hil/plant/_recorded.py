"""Where the replay of a recording begins: at what first samples show, within their noise.

There it begins where the next seconds suit best.
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
_VALUES = 10.0  # independent ones that a misfit holds: one an octave
_DIGITS = 1e-6  # of a channel's rms: its noise at least
_AHEAD = (0.0, 0.5, -0.5)  # of how far a vehicle may be: where it is looked for, as a play has many minima
_ROUNDS = 8  # outputs change nearly linearly with a start
_HALVED = 4  # times is a step halved that leads nowhere
_SETTLED = 1e-6  # of the squares: a step that takes off less is the last one
_STEP = 1e-3  # of a channel's rms, for derivatives
_SMALL = 0.02  # the same of what nobody reads, of how far that may be
_FAR = 1e9  # noises: a model that runs away is so far off, not infinitely far


def beginning(values: Array) -> tuple[float, float]:
    """What a channel shows at first, and how far that may be off; NaN where it was not recorded.

    That is its standard error and what it moves by meanwhile.
    """
    if not np.isfinite(values[0]):
        return float("nan"), float("nan")
    for count in _SAMPLES:
        head = values[:count]
        noise = white_noise(head)
        if np.std(head) <= 1.5 * noise:
            early, late = np.mean(head[: count // 2]), np.mean(head[count // 2 :])
            return float(np.mean(head)), float(noise / np.sqrt(len(head)) + abs(late - early))
    return float(values[0]), white_noise(values[: _SAMPLES[0]])


def white_noise(values: Array) -> float:
    """Standard deviation of noise, by second differences: motion is straight from sample to sample."""
    bent = np.abs(np.diff(values, 2))
    return float(np.median(bent) / (0.6745 * np.sqrt(6.0))) if len(bent) else 0.0


def settled(
    first: Array, errors: Array, unrecorded: Array, measured: Array, show: Callable[[Array], Array]
) -> Array:
    """The states of a start that suit the beginning of a recording best.

    Motor speed, wheel speed (rad/s), shaft torque (N m), and what nobody reads: how far a vehicle is ahead of
    the wheel (rad/s) and its tyre twisted (rad).

    What a model gets wrong is no noise: it holds few independent values, so that the first samples count for
    more. A start does not hide what a model lacks.

    Args:
        first: (5,), what first samples show; a channel that was not recorded follows from others.
        errors: (5,), standard errors of that.
        unrecorded: (5,), what a torque that was not recorded may have added before the first sample.
        measured: n x 3, NaN where a channel was not recorded.
        show: gives the outputs (starts x n x 3) from starts (starts x 5).
    """
    unsure = np.hypot(errors, unrecorded)
    there = np.isfinite(measured[0])
    if not there.any() or not np.any(unsure > 0.0):
        return first
    size = np.sqrt(np.mean(np.where(there, measured, 0.0) ** 2, axis=0))
    noise = np.nan_to_num(np.array([white_noise(one) for one in measured.T]))
    noise = np.maximum(noise, _DIGITS * np.where(size > 0.0, size, 1.0))
    steps = np.append(_STEP * np.where(size > 0.0, size, 1.0), _SMALL * unsure[3:])

    def away(starts: Array) -> Array:
        error = np.where(there, measured - show(starts), 0.0) / noise
        return np.asarray(np.clip(np.nan_to_num(error, nan=_FAR), -_FAR, _FAR), dtype=float)

    unread = np.append(np.zeros(3), unsure[3:])
    begins = [first + share * unread for share in (_AHEAD if unread.any() else _AHEAD[:1])]
    ends = [_least(first, unsure, steps, away, np.where(there, 1.0, 0.0), one) for one in begins]
    squares = np.mean(away(np.stack(ends)) ** 2, axis=1)
    nearest = int(np.argmin(np.maximum(np.sum(squares, axis=1), _SETTLED)))  # digits tell none from another
    start, misfit = ends[nearest], np.maximum(squares[nearest], 1.0)
    counts = 1.0 / (1.0 + (misfit - 1.0) * len(measured) / _VALUES)
    unsure = np.hypot(errors, unrecorded / np.max(misfit))  # of a wrong model it would take up the misfit
    return _least(first, unsure, steps, away, np.where(there, counts, 0.0), start if unread.any() else first)


def _least(
    first: Array,
    unsure: Array,
    steps: Array,
    away: Callable[[Array], Array],
    counts: Array,
    start: Array,
) -> Array:
    """The likeliest start, by Gauss and Newton's steps from another.

    Args:
        unsure: how far `first` may be off.
        away: errors (starts x n x 3) of starts in noises.
        counts: (3,), what an error of each channel counts for.
    """
    free = np.flatnonzero(unsure > 0.0)

    def rows(starts: Array) -> Array:
        whole = (away(starts) * np.sqrt(counts)).reshape(len(starts), -1)
        return np.concatenate([whole, ((starts - first) / np.maximum(unsure, 1e-300))[:, free]], axis=1)

    start = start.astype(float)
    left = rows(start[None])[0]
    for _ in range(_ROUNDS):
        if left @ left < _SETTLED * len(left):
            break  # a thousandth of the noise: digits of the equations
        slopes = (rows(start + np.diag(steps)[free]) - left) / steps[free, None]
        step = np.zeros(len(start))
        step[free] = -np.linalg.lstsq(slopes.T, left, rcond=None)[0]
        for _ in range(_HALVED):
            after = rows((start + step)[None])[0]
            if after @ after < left @ left:
                break
            step *= 0.5  # contact comes and goes on the way
        else:
            break
        had, has = left @ left, after @ after
        start, left = start + step, after
        if had - has < _SETTLED * has:
            break
    return start
