"""The likelihood of errors: proven noise plus a coloured discrepancy whose scale the data set.

In a window of some seconds each channel c and octave k has n bins of power P, mean over windows. Proven noise
of power N fills them independently, as in Whittle's likelihood (P. Whittle, Arkiv för Matematik 2 (1953)
423). What no formula gets right does not: it comes from a few reversals, steps or slips, so that all bins of
an octave rise and fall together and hold one independent value; and a part δ of each channel is right in no
model. So n values count near the noise and one far from it, and nothing counts below δ:

    dlog L = -(1 + (n - 1) N/P) dP / (P + δ²),  from log L = 0 at P = N, hence
    log L = -log((P + δ²)/(N + δ²)) - (n - 1) N/δ² (log(1 + δ²/N) - log(1 + δ²/P)).

A torque that repeats itself shows the same discrepancy in every period (R. Pintelon, J. Schoukens, System
Identification (2012), ch. 4), so that bins of an octave of all periods rise and fall together.

So misfit counts with its own correlation: a name that ends in noise has odds as sharp as noise allows, two
names far from it have modest ones, and no hypothesis gets a discrepancy for nothing (M. Kennedy, A. O'Hagan,
J. R. Statist. Soc. B 63 (2001) 425; J. Brynjarsdóttir, A. O'Hagan, Inverse Problems 30 (2014) 114007; a power
likelihood in the sense of J. Miller, D. Dunson, J. Am. Statist. Assoc. 114 (2019) 1113).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.special import gammaincinv, gammaln

Array = npt.NDArray[np.float64]
Channels = npt.NDArray[np.bool_]

SEGMENT_S = 4.0
"""Windows in which errors are compared; a misfit slower than this counts once a window."""
RIGHT_TO = 1e-3
"""Share of a channel's rms to which no model of a driveline is right, in any octave."""
_LAPPED = 0.5  # of a window is new: the rest was in the one before
_QUIET = 0.25  # of the windows
_SURE = 3.0  # standard errors, as many octaves are looked at
_HANN_BINS = 1.5  # of a transform with Hann's window hold one value
_LOWEST_HZ = 0.5  # upper edge of the first band; each further band is an octave wide


@dataclass(frozen=True)
class Spectrum:
    """Variance per block mean by channel and band (3 x bands), by which errors are weighed.

    It is that of noise and discrepancy together, and larger where bins of a discrepancy hold one value.
    """

    edges_hz: Array
    variance: Array

    def weights(self, length: int, rate_hz: float, lowest_hz: float) -> Array:
        """One over the standard deviation of each bin of a transform of so many blocks: bins x 3.

        Zero in bands below `lowest_hz`, which do not count.
        """
        bands = np.where(self.edges_hz[1:] > lowest_hz, 1.0 / np.sqrt(self.variance), 0.0)
        return np.asarray(bands.T[_bands(self.edges_hz, length, rate_hz)])

    def weighed(
        self, values: Array, channels: Channels, rate_hz: float, lowest_hz: float, room: int = 0
    ) -> Array:
        """sets x blocks x channels as numbers, sets x numbers, half whose squares add to -log L.

        Args:
            channels: which of the three `values` has.
            lowest_hz: bands below do not count.
            room: for so many numbers of each set behind these.
        """
        firsts, window = _windows(values.shape[1], rate_hz)
        weights = self.weights(len(window), rate_hz, lowest_hz).T[channels, None]
        shape = (len(weights), len(firsts), weights.shape[2])
        numbers = 2 * math.prod(shape)
        out = np.empty((len(values), numbers + room))
        for one, row in zip(values, out, strict=True):  # set by set, as it stays in the processor's cache
            transform = row[:numbers].view(complex).reshape(shape)
            transformed(one[None], rate_hz, transform[None])
            transform *= weights
        return out

    def by_octave(self, rows: Array, channels: Channels, blocks: int, rate_hz: float) -> tuple[Array, Array]:
        """Products of rows with each other: of `weighed` numbers 3 x bands x rows x rows, of those behind."""
        firsts, window = _windows(blocks, rate_hz)
        bands = _bands(self.edges_hz, len(window), rate_hz)
        seen = np.flatnonzero(channels)
        shape = (len(rows), len(seen), len(firsts), 2 * len(bands))
        numbers, behind = rows[:, : math.prod(shape[1:])].reshape(shape), rows[:, math.prod(shape[1:]) :]
        found = np.zeros((len(channels), len(self.edges_hz) - 1, len(rows), len(rows)))
        edges = 2 * np.searchsorted(bands, np.arange(len(self.edges_hz)))
        for place, channel in enumerate(seen.tolist()):
            for band, (low, high) in enumerate(pairwise(edges.tolist())):
                inside = numbers[:, place, :, low:high].reshape(len(rows), len(firsts) * (high - low))
                found[channel, band] = inside @ inside.T
        return found, behind @ behind.T

    def rising(self, values: Array, channels: Channels, rate_hz: float) -> Array:
        """sets x blocks x channels as weighed numbers of the beginning, where windows weigh little.

        The first window rises from zero: what it leaves of a block's weight counts by the whole variance.
        """
        weight = _unseen(values.shape[1], rate_hz)
        bins = np.bincount(
            _bands(self.edges_hz, _window_of(values.shape[1], rate_hz), rate_hz),
            minlength=len(self.edges_hz) - 1,
        )
        scale = np.sqrt(self.variance[channels] @ bins / np.sum(bins))
        part = values[:, : len(weight)] * weight[:, None] / scale
        return np.asarray(part.reshape(len(values), math.prod(part.shape[1:])), dtype=float)

    def sent_back(self, values: Array, channels: Channels, rate_hz: float, lowest_hz: float) -> Array:
        """Slope of half the squares of `weighed` by each of values (blocks x channels): its transpose."""
        firsts, window = _windows(len(values), rate_hz)
        length = len(window)
        slopes = transformed(values[None], rate_hz)[0]
        slopes *= self.weights(length, rate_hz, lowest_hz).T[channels, None] ** 2
        slopes[..., 0] *= 2.0  # of one sign of frequency only
        if length % 2 == 0:
            slopes[..., -1] *= 2.0
        parts = 0.5 * length * np.fft.irfft(slopes, length) * window
        back = np.zeros(values.shape)
        for place, first in enumerate(firsts.tolist()):
            back[first : first + length] += parts[:, place].T
        return back


def edges_hz(rate_hz: float) -> Array:
    """Of the bands: octaves up to half the rate."""
    octaves = max(1, int(np.ceil(np.log2(0.5 * rate_hz / _LOWEST_HZ))))
    return np.concatenate([[0.0], _LOWEST_HZ * 2.0 ** np.arange(octaves), [0.5 * rate_hz * 1.001]])


def of_noise(noise: Array, rate_hz: float, colour: Array | None = None) -> Spectrum:
    """Noise alone, of `noise` standard deviations (3,); white, or of a colour (3 x bands) around 1."""
    edges = edges_hz(rate_hz)
    colour = np.ones((len(noise), len(edges) - 1)) if colour is None else colour
    return Spectrum(edges, (noise**2)[:, None] * colour)


@dataclass(frozen=True)
class Powers:
    """Mean power of errors by window, channel and band, and how many independent bins it is of.

    `power` and `bins` are windows x 3 x bands; a channel that is missing has no bins. `signal` is
    the mean square of each channel (3,), `repeated` (windows,) how many windows show the same discrepancy
    (of a torque that repeats itself), None where each shows its own. `colour` (3 x bands) is that of noise.
    """

    edges_hz: Array
    power: Array
    bins: Array
    signal: Array
    repeated: Array | None = None
    colour: Array | None = None

    def spectrum(self, noise: Array) -> Spectrum:
        """The scale of noise and discrepancy that suits these errors best."""
        return Spectrum(self.edges_hz, 1.0 / -self._slope(*self._terms(noise)))

    def log_likelihood(self, noise: Array) -> Array:
        """Of each window, (windows,): the sum is that of the means, each window's part is to first order."""
        p, n, d, inside = self._terms(noise)
        slope = inside * self._slope(p, n, d, inside)
        each = self._of_means(p, n, d, inside) + slope * (self.power - p)
        terms = np.where(self.bins > 0.0, self.bins / inside * each, 0.0)
        return np.asarray(np.sum(terms, axis=(1, 2)))

    def most_to_gain(self, noise: Array, stays: Array) -> float:
        """Growth of the log likelihood if no more than such powers (3 x bands) stayed in any octave."""
        p = self._terms(noise)[0]
        return self.growth(noise, np.minimum(stays / p, 1.0))

    @staticmethod
    def _of_means(p: Array, n: Array, d: Array, inside: Array) -> Array:
        """Log likelihood of an octave by its mean power (3 x bands)."""
        shared = np.log1p(d / n) - np.log1p(d / p)
        return np.asarray(-np.log((p + d) / (n + d)) - (inside - 1.0) * n / d * shared)

    def growth(self, noise: Array, stays: Array) -> float:
        """Of the log likelihood where such shares of the power of each octave (3 x bands) stay."""
        p, n, d, inside = self._terms(noise)
        more = self._of_means(np.maximum(stays * p, n), n, d, inside) - self._of_means(p, n, d, inside)
        return float(np.sum(self.bins.sum(axis=0) / inside * more))

    def weights(self, noise: Array, stays: Array) -> Array:
        """Of each octave (3 x bands) where such shares of its power stay, in those that it has now."""
        p, n, d, inside = self._terms(noise)
        return self._slope(np.maximum(stays * p, n), n, d, inside) / self._slope(p, n, d, inside)

    def values(self, noise: Array) -> float:
        """Independent values that errors hold: two for a bin of noise, two for an octave of discrepancy."""
        p, n, d, inside = self._terms(noise)
        each = -self._slope(p, n, d, inside) * p
        return float(2.0 * np.sum(self.bins * each))

    @staticmethod
    def _slope(p: Array, n: Array, d: Array, inside: Array) -> Array:
        """Of the log likelihood by the power of each bin (3 x bands)."""
        return np.asarray(-(1.0 + (inside - 1.0) * n / p) / (p + d) / inside)

    def mean_square(self, power: Array | None = None) -> Array:
        """Of each channel over what counts, (3,), as if its noise were white; NaN where nothing does.

        Args:
            power: of something else, 3 x bands.
        """
        count = np.sum(self.bins, axis=(0, 2))
        power = self.power if power is None else power
        sums = np.sum(self.bins * (power if self.colour is None else power / self.colour), axis=(0, 2))
        return np.where(count > 0.0, sums / np.maximum(count, 1e-300), np.nan)

    def quiet(self, noise: Array) -> Array:
        """Power that quiet windows show as well, and the most that it may be: 2 x 3 x bands.

        It is the lower quartile over windows, as that of so many bins of noise is (a gamma distribution); at
        least white noise, and at most what lower octaves may be, since no sensor's noise rises. The lowest
        octave, in which an offset stands, is taken as the next one. The most is `_SURE` standard errors above
        it.
        """
        white = self._terms(noise)[1]
        found = np.stack([white, white])
        for channel in range(len(white)):
            most = math.inf
            used = np.flatnonzero(self.bins[:, channel].any(axis=0)).tolist()
            for band in used[1:] or used:
                counts = self.bins[:, channel, band] > 0.0
                shape = self.bins[counts, channel, band].mean() / _LAPPED / _HANN_BINS
                usual, slope = _lower_quartile(float(shape))
                error = np.sqrt(_QUIET * (1.0 - _QUIET) / counts.sum()) / slope
                level = np.quantile(self.power[counts, channel, band], _QUIET) / usual * shape
                over = min(max(float(level) / white[channel, band], 1.0), most)
                most = min(most, over * (1.0 + _SURE * float(error)))
                found[:, channel, band] *= over, most
            found[:, channel, used[:1]] *= (found[:, channel] / white[channel])[:, used[1:2]]
        return found

    def _terms(self, noise: Array) -> tuple[Array, Array, Array, Array]:
        """Mean power, at least that of noise; noise; what no model is right to; bins of one discrepancy."""
        total = np.sum(self.bins, axis=0)
        n = np.where(np.isfinite(noise), noise, 1.0)[:, None] ** 2 * np.ones_like(total)
        if self.colour is not None:
            n *= self.colour
        p = np.maximum(np.sum(self.bins * self.power, axis=0) / np.maximum(total, 1e-300), n)
        d = np.where(self.signal > 0.0, RIGHT_TO**2 * self.signal, 1.0)[:, None] * np.ones_like(total)
        inside = np.maximum(np.max(self.bins, axis=(0, 1)) / _LAPPED, 1.0) * np.ones_like(total)
        if self.repeated is not None:
            inside *= total / np.maximum(np.sum(self.bins / self.repeated[:, None, None], axis=0), 1e-300)
        return p, n, d, np.maximum(inside, 1.0)


def transformed(
    values: Array, rate_hz: float, out: npt.NDArray[np.complex128] | None = None
) -> npt.NDArray[np.complex128]:
    """Windows of values (sets x blocks x channels) by frequency: sets x channels x windows x bins.

    Hann's windows of `SEGMENT_S` or the whole, lapped by half or more, so that a slow misfit does not leak
    into the octaves of noise; squares over windows and bins are powers of a block times bins.
    """
    firsts, window = _windows(values.shape[1], rate_hz)
    parts = np.empty((len(values), values.shape[2], len(firsts), len(window)))
    for place, first in enumerate(firsts.tolist()):
        np.multiply(values[:, first : first + len(window)].swapaxes(1, 2), window, out=parts[:, :, place])
    return np.asarray(np.fft.rfft(parts, out=out))


@lru_cache
def _windows(blocks: int, rate_hz: float) -> tuple[npt.NDArray[np.int64], Array]:
    """First block of each window of a recording of so many blocks, and the factor of each of its blocks."""
    length = _window_of(blocks, rate_hz)
    count = 1 + int(np.ceil((blocks - length) / max(1, length // 2)))
    window = np.sqrt(8.0 / 3.0 / length) * (
        0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(length) + 0.5) / length)
    )
    return np.linspace(0, blocks - length, count).round().astype(np.int64), window


@lru_cache
def _unseen(blocks: int, rate_hz: float) -> Array:
    """Root of the share of each block's weight that a recording's first window leaves, as it rises."""
    firsts, window = _windows(blocks, rate_hz)
    length = len(window)
    seen = np.zeros(blocks)
    for first in firsts.tolist():
        seen[first : first + length] += window**2
    rises = seen[: length // 2] * length / 2.0
    return np.asarray(np.sqrt(np.maximum(1.0 - rises, 0.0)))


@lru_cache
def _lower_quartile(shape: float) -> tuple[float, float]:
    """Of a gamma distribution, and its density there times that."""
    usual = float(gammaincinv(shape, _QUIET))
    return usual, math.exp(shape * math.log(usual) - usual - float(gammaln(shape)))


def powers_of(
    errors: Sequence[Array],
    rate_hz: float,
    signal: Array,
    lowest_hz: Sequence[float] | None = None,
    periods: Sequence[float] | None = None,
    colour: Array | None = None,
) -> Powers:
    """Powers of errors of each recording (blocks x 3, NaN where not recorded), by half-lapped windows.

    Args:
        lowest_hz: of each recording: bands below do not count; zero when left out.
        periods: of each recording: how often its torque repeats itself; once when left out.
        colour: of noise, 3 x bands; white when left out.
    """
    edges = edges_hz(rate_hz)
    power, bins, repeated = [], [], []
    each = zip(errors, lowest_hz or [0.0] * len(errors), periods or [1.0] * len(errors), strict=True)
    for error, lowest, times in each:
        squares = np.abs(transformed(error[None], rate_hz)[0]) ** 2
        band = _bands(edges, _window_of(len(error), rate_hz), rate_hz)
        inside = np.stack([np.bincount(band, minlength=len(edges) - 1)] * error.shape[1]).astype(float)
        windows = squares.shape[1]
        repeated += [max(1.0, min(times, _LAPPED * windows))] * windows
        for one in squares.swapaxes(0, 1):
            sums = np.stack([np.bincount(band, column, len(edges) - 1) for column in one])
            there = np.isfinite(sums)
            power.append(np.where(there, sums / np.maximum(inside, 1.0), 0.0))
            bins.append(np.where(there & (edges[1:] > lowest), _LAPPED * inside, 0.0))
    return Powers(edges, np.array(power), np.array(bins), signal, np.array(repeated), colour)


def _window_of(blocks: int, rate_hz: float) -> int:
    """Blocks of a window of a recording of so many blocks."""
    return min(blocks, round(SEGMENT_S * rate_hz))


def _bands(edges: Array, length: int, rate_hz: float) -> npt.NDArray[np.int64]:
    """Band of each bin of a transform of so many blocks."""
    return bands_of(edges, np.fft.rfftfreq(length, 1.0 / rate_hz).astype(np.float64))


def bands_of(edges: Array, frequency_hz: Array) -> npt.NDArray[np.int64]:
    """Band of each frequency."""
    found = np.searchsorted(edges, frequency_hz, side="right") - 1
    return np.asarray(np.clip(found, 0, len(edges) - 2))
