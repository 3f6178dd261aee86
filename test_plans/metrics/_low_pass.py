"""Filters and spectra of metrics: a Butterworth low-pass without delay, and power density of a window.

scipy.signal has both, and takes longer to import than a plan takes to be predicted and judged.
"""

from __future__ import annotations

import math

import numpy as np

from hil.core.runtime.compiled import compiled
from test_plans.conductor import Array

ORDER = 2


def low_passed(values: Array, corner_hz: float, spacing_s: float) -> Array:
    """`values`, shape (n,), every `spacing_s`, without what lies above `corner_hz`.

    Both ends are continued by their point reflection for a period of the corner frequency, so that the
    filter starts and ends at rest (`scipy.signal.sosfiltfilt` with `padtype="odd"`).
    """
    padding = min(len(values) - 1, math.ceil(1 / (corner_hz * spacing_s)))
    head = 2 * values[0] - values[padding:0:-1]
    tail = 2 * values[-1] - values[-2 : -padding - 2 : -1]
    padded = np.concatenate([head, values, tail])
    b, a_1, a_2 = _butterworth(corner_hz * spacing_s)
    _run(padded, b, a_1, a_2)
    _run(padded[::-1], b, a_1, a_2)
    return padded[padding : len(padded) - padding]


def _butterworth(corner: float) -> tuple[float, float, float]:
    """b_0 = b_1/2 = b_2, a_1 and a_2 for a corner in cycles a sample (Tustin's rule, prewarped)."""
    w = math.tan(math.pi * corner)
    whole = 1 + math.sqrt(2) * w + w * w
    return w * w / whole, 2 * (w * w - 1) / whole, (1 - math.sqrt(2) * w + w * w) / whole


@compiled
def _run(x, b, a_1, a_2):  # type: ignore[no-untyped-def]
    """Filter in place, from a state as if the first value had been there for ever."""
    first = (1.0 - b) * x[0]
    second = (b - a_2) * x[0]
    for i in range(x.shape[0]):
        y = b * x[i] + first
        first = 2.0 * b * x[i] - a_1 * y + second
        second = b * x[i] - a_2 * y
        x[i] = y


def periodogram(values: Array, spacing_s: float, *, tapered: bool = True) -> tuple[Array, Array]:
    """Frequencies in Hz and the one-sided density in the values' unit squared per Hz, each (n // 2 + 1,).

    The linear trend (least squares) is removed, then, if it is to be `tapered`, a periodic Hann window is
    applied, as by `scipy.signal.periodogram` ("hann" or "boxcar") behind `scipy.signal.detrend`.
    """
    count = len(values)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(count) / count) if tapered else np.ones(count)
    lines = np.fft.rfft(without_trend(values) * window)
    density = (lines.real**2 + lines.imag**2) * spacing_s / (window @ window)
    density[1 : (count + 1) // 2] *= 2.0  # every line but zero and half the rate stands for two
    return np.asarray(np.fft.rfftfreq(count, spacing_s)), density


def energy_within(frequency: Array, density: Array, from_hz: float, to_hz: float) -> float:
    """Mean square between two frequencies: a line counts with the share of its width that lies within.

    Args:
        frequency: lines in Hz from zero on, evenly spaced, shape (n,).
        density: one-sided power spectral density there, in a unit squared per Hz, shape (n,).
    """
    half_hz = 0.5 * (frequency[1] - frequency[0])
    upper, lower = np.minimum(frequency + half_hz, to_hz), np.maximum(frequency - half_hz, from_hz)
    return float(density @ np.maximum(upper - lower, 0.0))


def hann(count: int) -> Array:
    """A Hann window, symmetric and nowhere zero: as good a weight for means as for lines; shape (count,)."""
    return np.asarray(0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(count) + 0.5) / count))


def without_trend(values: Array) -> Array:
    """`values` less their linear trend (least squares), of their shape (n,)."""
    position = np.arange(len(values)) - 0.5 * (len(values) - 1)
    around = values - np.mean(values)
    slope = position @ around / np.maximum(position @ position, 1e-300)
    return np.asarray(around - slope * position)
