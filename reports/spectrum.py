"""The amplitude spectrum that reports draw: a sine of amplitude A on a frequency line reads A."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from reports.quantities import THIN

Array = npt.NDArray[np.float64]

DESCRIPTION = "Single-sided amplitude spectrum, linear trend removed"
_LEAST_SAMPLES = 16
_LARGEST_MISSING_SHARE = 0.05


@dataclass(frozen=True)
class Spectrum:
    """Amplitudes (unit of the channel) over frequencies (Hz), both 1-D of one length, without 0 Hz."""

    frequency_hz: Array
    amplitude: Array

    @property
    def resolution_hz(self) -> float:
        """Distance of the frequency lines."""
        return float(self.frequency_hz[0])


def stretch_in_words(window_s: tuple[float, float], lengths_s: Iterable[float]) -> str:
    """What of a window after the step the spectra of stretches show that end so long after their steps."""
    start, end = window_s
    ends = sorted({f"{min(end, round(length, 3)):g}" for length in lengths_s}, key=float)
    return f"{start:g} to {' or '.join(ends)}{THIN}s after the step"


def amplitude_spectrum(time_s: Array, values: Array, *, hann: bool = True) -> Spectrum | None:
    """Spectrum of `values` at `time_s` (1-D, same length); uneven samples are put on an even grid first.

    `hann` suits steady parts of a signal; sweeps, which begin and end at rest, are taken without a window.
    None if there are fewer than 16 samples or more than 5 % of them are missing.
    """
    finite = np.isfinite(values) & np.isfinite(time_s)
    if finite.sum() < _LEAST_SAMPLES or np.mean(~finite) > _LARGEST_MISSING_SHARE:
        return None
    time_s, values = time_s[finite], values[finite]
    span = float(time_s[-1] - time_s[0])
    step = float(np.median(np.diff(time_s)))
    if not (span > 0 and step > 0):
        return None
    count = round(span / step) + 1
    if count < _LEAST_SAMPLES or count > 4 * len(values):
        return None
    grid = np.linspace(time_s[0], time_s[-1], count)
    even = np.interp(grid, time_s, values)
    centred = grid - grid.mean()
    even = even - even.mean() - centred * (centred @ even) / (centred @ centred)
    turn = 2 * np.pi * np.arange(count) / count
    window = 0.5 - 0.5 * np.cos(turn) if hann else np.ones(count)
    amplitude: Array = np.abs(np.fft.rfft(even * window)) * (2 / window.sum())
    frequency = np.arange(len(amplitude)) * (count - 1) / (count * span)
    return Spectrum(frequency[1:], amplitude[1:])
