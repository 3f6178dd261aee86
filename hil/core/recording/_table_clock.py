"""What the stamps of another tool's table are: a counter that begins again, or times that were rounded."""

from __future__ import annotations

import itertools

import numpy as np

from hil.core.channels import TIME
from hil.core.errors import BadInputError
from hil.core.recording._column_map import OPTION
from hil.core.recording._table import Array

_COUNTERS = (1 << 16, 1 << 32)
_MOST_STEPS = 20  # median steps that a counter may go on by where it begins again
_QUANTA_S = (1.0, 0.1, 0.01, 0.001)
_LEAST_SAMPLES, _LEAST_STRETCH, _WINDOW = 50, 20, 20
_BAND = 1.3  # of a quantum: residuals of stamps that are rounded, about a line fitted to them


def counted_on(stamps: Array, notes: list[str]) -> Array:
    """Stamps of a counter of 16 or 32 bits as one that goes on, in its own numbers; others as they are.

    A counter is known by whole numbers, none of them beyond its range, that go on where they begin again.
    """
    steps = np.diff(stamps)
    back = steps < 0
    if (
        not back.any()
        or not np.isfinite(stamps).all()
        or (stamps != np.rint(stamps)).any()
        or stamps.min() < 0
    ):
        return stamps
    forward = float(np.median(steps[~back])) if (~back).any() else 0.0
    for span in _COUNTERS:
        on = steps[back] + span
        if stamps.max() < span and (on > 0).all() and (on <= _MOST_STEPS * max(forward, 1.0)).all():
            count = int(np.count_nonzero(back))
            times = "once" if count == 1 else f"{count} times"
            notes.append(f"time counts in {span.bit_length() - 1} bits and begins again {times}: counted on")
            return np.asarray(stamps + span * np.concatenate([[0], np.cumsum(back)]))
    return stamps


def evenly_placed(time_s: Array, where: str, notes: list[str]) -> Array:
    """Stamps that are rounded to 1 s, 0.1 s, 10 ms or 1 ms, put where the samples' numbers place them.

    Within a stretch without a gap, samples that are evenly spaced have stamps about one line, no further from
    it than rounding takes them. Stamps of which that is not so stay as they are.

    Raises:
        BadInputError: many stamps stand several times, and the samples between are not evenly spaced.
    """
    quantum_s = _quantum_s(time_s)
    if not quantum_s:
        return time_s
    steps = np.rint(np.diff(time_s) / quantum_s)
    if (steps < 0).any() or (steps == steps[0]).all():
        return time_s
    window_s = time_s[_WINDOW:] - time_s[:-_WINDOW]
    apart_s = float(np.median(window_s)) / _WINDOW
    ends = np.flatnonzero(np.diff(time_s) > 3 * apart_s + 2 * quantum_s) + 1
    placed = _on_lines(time_s, [0, *ends.tolist(), len(time_s)], quantum_s)
    repeated = float(np.mean(steps == 0))
    if placed is None or (np.diff(placed) <= 0).any():
        if repeated > 0.01:
            raise BadInputError(
                f"{repeated:.0%} of the stamps in '{TIME}' repeat the one before: they are rounded to "
                f"{quantum_s:g} s, and samples are not evenly spaced",
                where=where,
                fix=f"export time with more digits, or give the distance of samples: {OPTION} "
                f"'{TIME}=, every_s={apart_s:.3g}'",
            )
        return time_s
    furthest_s = float(np.abs(placed - time_s).max())
    notes.append(
        f"stamps are rounded to {quantum_s * 1e3:g} ms: samples were placed {apart_s * 1e3:.4g} ms apart, "
        f"at most {furthest_s * 1e3:.3g} ms from their stamps"
    )
    return placed


def _quantum_s(time_s: Array) -> float:
    """The largest quantum of which all stamps are multiples; 0 if there is none or too few of them."""
    if len(time_s) < _LEAST_SAMPLES or not np.isfinite(time_s).all():
        return 0.0
    since_s = time_s - time_s[0]
    for quantum_s in _QUANTA_S:
        counts = since_s / quantum_s
        if np.all(np.abs(counts - np.rint(counts)) < 1e-4):
            return quantum_s
    return 0.0


def _on_lines(time_s: Array, ends: list[int], quantum_s: float) -> Array | None:
    """Each stretch on the line fitted to its stamps; None if a stretch is short or far from its line."""
    placed = np.empty(len(time_s))
    for begin, end in itertools.pairwise(ends):
        if end - begin < _LEAST_STRETCH:
            return None
        numbers = np.arange(end - begin, dtype=np.float64)
        numbers -= numbers.mean()
        own_s = time_s[begin:end]
        middle_s = float(own_s.mean())
        slope_s = float(numbers @ (own_s - middle_s)) / float(numbers @ numbers)
        line_s = middle_s + slope_s * numbers
        if np.ptp(own_s - line_s) > _BAND * quantum_s:
            return None
        placed[begin:end] = line_s
    return placed
