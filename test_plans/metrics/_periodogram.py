"""Power spectral density of a whole window and what of it lies in a band; scipy.signal is slow to import."""

from __future__ import annotations

import numpy as np

from test_plans.conductor import Array


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
