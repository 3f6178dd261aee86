"""The likelihood of errors: proven noise plus a coloured discrepancy whose scale the data set.

Whittle's likelihood of a stationary process (P. Whittle, Arkiv för Matematik 2 (1953) 423): of each channel c
and band k with n_ck independent bins of mean power P_ck,

    log L = -Σ n_ck (log s_ck² + P_ck / s_ck²),    s_ck² = max(noise_c², P_ck),

with P_ck over all recordings. So what no formula gets right has a spectrum of its own, which is part of the
estimate: slow misfit has few bins and counts little however large it is, and no hypothesis gets it for nothing
(M. Kennedy, A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425; J. Brynjarsdóttir, A. O'Hagan, Inverse Problems 30
(2014) 114007).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

SEGMENT_S = 4.0
"""Windows in which errors are compared; a misfit slower than this counts once a window."""
_LOWEST_HZ = 0.5  # upper edge of the first band; each further band is an octave wide


@dataclass(frozen=True)
class Spectrum:
    """Variance per block mean by channel and band (3 x bands), of noise and discrepancy together."""

    edges_hz: Array
    variance: Array

    def weights(self, length: int, rate_hz: float) -> Array:
        """What the transform of `length` errors is multiplied by: bins x 3, so that squares add to -log L."""
        frequency = np.fft.rfftfreq(length, 1.0 / rate_hz)
        band = np.clip(np.searchsorted(self.edges_hz, frequency, side="right") - 1, 0, len(self.edges_hz) - 2)
        twice = np.where(frequency > 0.0, 2.0, 1.0)
        return np.asarray(np.sqrt(twice[:, None] / (length * self.variance.T[band])))


def edges_hz(rate_hz: float) -> Array:
    """Of the bands: octaves up to half the rate."""
    octaves = max(1, int(np.ceil(np.log2(0.5 * rate_hz / _LOWEST_HZ))))
    return np.concatenate([[0.0], _LOWEST_HZ * 2.0 ** np.arange(octaves), [0.5 * rate_hz * 1.001]])


def white(noise: Array, rate_hz: float) -> Spectrum:
    """Noise alone, of `noise` standard deviations (3,)."""
    edges = edges_hz(rate_hz)
    return Spectrum(edges, np.repeat((noise**2)[:, None], len(edges) - 1, axis=1))


@dataclass(frozen=True)
class Powers:
    """Mean power of errors by window, channel and band, and how many independent bins it is of.

    `power` and `bins` are windows x 3 x bands; a channel that is missing has no bins. `window_of` tells the
    recording of each window.
    """

    edges_hz: Array
    power: Array
    bins: Array
    recording: npt.NDArray[np.int64]

    def spectrum(self, noise: Array) -> Spectrum:
        """The scale of noise and discrepancy that suits these errors best."""
        total = np.sum(self.bins, axis=0)
        mean = np.sum(self.bins * self.power, axis=0) / np.maximum(total, 1.0)
        return Spectrum(self.edges_hz, np.maximum(mean, noise[:, None] ** 2))

    def log_likelihood(self, spectrum: Spectrum) -> Array:
        """Of each window, shape (windows,)."""
        v = np.where(np.isfinite(spectrum.variance), spectrum.variance, 1.0)
        terms = np.where(self.bins > 0, self.bins * (np.log(v) + self.power / v), 0.0)
        return np.asarray(-np.sum(terms, axis=(1, 2)))


def powers_of(errors: Sequence[Array], rate_hz: float) -> Powers:
    """Powers of errors of each recording (blocks x 3, NaN where a channel is missing), by half-lapped windows."""
    edges = edges_hz(rate_hz)
    power, bins, which = [], [], []
    for index, error in enumerate(errors):
        length = min(len(error), round(SEGMENT_S * rate_hz))
        window = np.sqrt(8.0 / 3.0) * (0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(length) + 0.5) / length))
        band = np.searchsorted(edges, np.fft.rfftfreq(length, 1.0 / rate_hz), side="right") - 1
        hop = max(1, length // 2)
        inside = np.stack([np.bincount(band, minlength=len(edges) - 1)] * error.shape[1]).astype(float)
        for first in range(0, len(error) - length + 1, hop):
            part = error[first : first + length]
            spectrum = np.abs(np.fft.rfft(part * window[:, None], axis=0)) ** 2 / length
            sums = np.stack([np.bincount(band, column, len(edges) - 1) for column in spectrum.T])
            there = np.isfinite(sums)
            power.append(np.where(there, sums / np.maximum(inside, 1.0), 0.0))
            bins.append(np.where(there, 0.5 * inside, 0.0))  # half the window was seen before
            which.append(index)
    return Powers(edges, np.array(power), np.array(bins), np.array(which))
