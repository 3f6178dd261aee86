"""Lines of a signal that last: a limit cycle of a control loop has the loop's frequency, and stays."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from test_plans.conductor import Array
from test_plans.metrics._low_pass import hann, without_trend

DECAYS = 0.7  # a line that has this share left at the end decays
_PERIODS = 3  # that make an oscillation
_BLOCK_S, _LEAST_BLOCKS = 0.5, 4  # in which lines are looked for
_FINER = 16  # lines of the spectra between those of the window
_LOWEST_PERIODS = 2.0  # of a line within its block: slower motion is seen by means
_FLOOR = 5.0  # times the median of a spectrum: less is noise
_MONOTONE = 1.1  # a line that decays has no block in which it is so much larger than before


@dataclass(frozen=True)
class Line:
    """Amplitude in the signal's unit, and frequency."""

    amplitude: float
    frequency_hz: float


def lasting_line(values: Array, spacing_s: float) -> Line:
    """The strongest line that lasts, comes, or comes again, looked for in blocks of half a second.

    A line that only decays counts as it is in the middle block: one that lasts until shortly before the end
    is still there, one that decays has gone.

    Args:
        values: shape (n,), every `spacing_s`.
    """
    length = min(round(_BLOCK_S / spacing_s), len(values) // _LEAST_BLOCKS)
    last = len(values) - length
    starts = np.unique(np.linspace(0, last, 1 + int(np.ceil(2 * last / length))).astype(int))
    blocks = [_strongest(values[start : start + length], spacing_s) for start in starts]
    sizes = np.array([line.amplitude for line in blocks])
    decays = bool(np.all(sizes[1:] <= _MONOTONE * np.minimum.accumulate(sizes)[:-1]))
    return blocks[len(blocks) // 2] if decays else max(blocks, key=lambda line: line.amplitude)


@dataclass(frozen=True)
class Swings:
    """Half the distance between a peak and the trough after it, of the first and the last such pair."""

    frequency_hz: float
    first: float
    last: float


def swings(values: Array, spacing_s: float) -> Swings | None:
    """The oscillation of a signal around its own mean; None with less than three periods."""
    around = values - np.mean(values)
    crossings = np.flatnonzero(np.diff(np.sign(around)) != 0)
    halves = [around[a : b + 1] for a, b in itertools.pairwise(crossings)]
    extremes = [float(np.max(np.abs(half))) for half in halves]
    if not extremes:
        return None
    largest = max(extremes)
    firm = [place for place, size in enumerate(extremes) if size > 0.1 * largest]  # noise crosses zero too
    if len(firm) < 2 * _PERIODS:
        return None
    length_s = (crossings[firm[-1] + 1] - crossings[firm[0]]) * spacing_s
    first = 0.5 * (extremes[firm[0]] + extremes[firm[1]])
    last = 0.5 * (extremes[firm[-2]] + extremes[firm[-1]])
    return Swings(0.5 * len(firm) / float(length_s), first, last)


def _strongest(values: Array, spacing_s: float) -> Line:
    """The strongest line of a signal, linear trend removed, Hann window; none where all is noise."""
    count = len(values)
    taper = hann(count)
    lines = np.abs(np.fft.rfft(without_trend(values) * taper, _FINER * count))
    frequency = np.fft.rfftfreq(_FINER * count, spacing_s)
    lines[frequency * count * spacing_s < _LOWEST_PERIODS] = 0.0
    place = int(np.argmax(lines))
    if lines[place] < _FLOOR * float(np.median(lines)):
        return Line(0.0, float(frequency[place]))
    return Line(float(2.0 * lines[place] / np.sum(taper)), float(frequency[place]))
