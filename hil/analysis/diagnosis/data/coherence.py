"""How much of an error is physics, and how much is noise, however coloured the noise is.

Two things tell them apart. Noise of one sensor knows nothing of the other sensors nor of the request, while
what is missing in the plant shows in several channels at once, and what is wrong in a sensor goes with what
the channel shows: the multiple coherence of each channel's error with the other errors, the simulated
channels and the request (Bendat and Piersol, Random Data, chapter 7). And noise of a sensor is the same all
the time, while physics comes and goes with speed and torque: the mean of the error's spectrum over many
short segments against its median. What is slower than a segment and stands far above the rest of the spectrum
is drift of the simulation, not noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import (
    FED_BACK,
    KEPT,
    LEAST_SEGMENTS,
    LOOP_BAND,
    LOOP_COHERENT,
    LOOP_NOISE,
    NEIGHBOURS,
    RED,
    SEGMENT_S,
    SEGMENTS_ALIKE,
    SLOW_LINES,
)
from hil.analysis.diagnosis.data.trace import Trace, blocks
from hil.core.errors import BadInputError

_REQUEST = 6  # column of it among the signals

Array = npt.NDArray[np.float64]
Spectra = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Split:
    """Mean squared weighted error of each channel (3,), 0 where not measured: physics, and noise.

    `deviation` is the standard deviation that `physics` has where there is none.
    """

    physics: Array
    noise: Array
    deviation: Array

    def within(self, proven: Array, white: Array) -> Split:
        """No more noise than is proven, and no less than what is white, both (3,) in the same unit.

        What lies above the one is physics, and physics is at most what lies above the other: in a closed loop
        noise is in the request too, and coherent with all that follows from it.
        """
        power = self.physics + self.noise
        noise = np.clip(self.noise, np.minimum(white, power), np.maximum(proven, white))
        return Split(power - noise, noise, self.deviation)


def split(traces: Sequence[Trace], weights: Sequence[Array], errors: Sequence[Array]) -> Split:
    """Split the weighted errors of a fit (blocks x 3 each recording) over all recordings.

    Args:
        weights: what one block's error was multiplied by, (3,) each recording, 0 for a missing channel.
    """
    spectra = _spectra(traces, weights, errors)
    products = np.einsum("kfi,kfj->fij", spectra, spectra.conj()) / len(spectra)
    segments = len(spectra) / (1.0 + 2.0 * SEGMENTS_ALIKE**2)
    physics, noise, deviation = np.zeros(3), np.zeros(3), np.zeros(3)
    for column in range(3):
        if not any(t.has[column] for t in traces):
            continue
        power = products[:, column, column].real
        known, variance = _explained(products, column, segments)
        passing = power - np.median(np.abs(spectra[:, :, column]) ** 2, axis=0) / np.log(2.0)
        passing[-1] = 0.0
        slow = power[:SLOW_LINES] - RED * np.array([0.5, 1.0]) * float(
            np.mean(power[SLOW_LINES : 3 * SLOW_LINES])
        )
        known[:SLOW_LINES] = passing[:SLOW_LINES] = np.maximum(known[:SLOW_LINES], slow)
        mine = known if np.sum(known) >= np.sum(passing) else passing
        physics[column] = float(np.sum(mine))
        if _is_fed_back(products, column, segments):
            physics[column] = max(0.0, physics[column] - LOOP_NOISE * float(np.sum(power)))
        noise[column] = float(np.sum(power)) - physics[column]
        deviation[column] = float(np.sqrt(variance @ np.maximum(power - mine, 0.0) ** 2))
    return Split(physics, noise, deviation)


def _explained(products: Spectra, column: int, segments: float) -> tuple[Array, Array]:
    """Power of `column` that the other signals explain at each frequency, freed of what chance explains.

    With it the variance of that, in squares of the power that nothing explains. In a closed loop the
    request, and all that is simulated from it, know the noise of the channel that is fed back: what these
    explain is physics at most by a share of what the channel itself shows at that frequency: where a loop
    answers to little but noise, noise is all that it shows.
    """
    size = products.shape[1]
    errors = [c for c in range(3) if c != column]
    others = [c for c in range(size) if c != column]
    across, _ = _coherent(products, column, errors, segments)
    altogether, rank = _coherent(products, column, others, segments)
    shown = products[:, 3 + column, 3 + column].real
    known = np.maximum(across, np.minimum(altogether, across + FED_BACK * shown))
    there = products[:, column, column].real > 0.0
    return np.where(there, known, 0.0), np.where(there, NEIGHBOURS * rank / segments**2, 0.0)


def _is_fed_back(products: Spectra, column: int, segments: float) -> bool:
    """Whether the request follows the noise of a channel: above all modes no plant follows a request."""
    band = products[round(LOOP_BAND * len(products)) :]
    error, request = band[:, column, column].real, band[:, _REQUEST, _REQUEST].real
    both = np.abs(band[:, column, _REQUEST]) ** 2
    seen = both / np.maximum(error * request, 1e-300)
    return bool(np.mean(seen) > LOOP_COHERENT + 1.0 / segments)


def _coherent(
    products: Spectra, column: int, others: list[int], segments: float
) -> tuple[Array, npt.NDArray[np.int_]]:
    """Power of `column` at each frequency that goes with `others`, less what chance gives.

    With it how many of these there really are.
    """
    power = products[:, column, column].real
    between = products[:, others][:, :, others]
    scale = np.sqrt(np.maximum(np.diagonal(between, axis1=1, axis2=2).real, 1e-300))
    values, vectors = np.linalg.eigh(between / (scale[:, :, None] * scale[:, None, :]))
    kept = values > KEPT * values[:, -1:]
    seen = vectors.conj().transpose(0, 2, 1) @ (products[:, others, column] / scale)[:, :, None]
    parts = np.where(kept, np.abs(seen[:, :, 0]) ** 2 / np.where(kept, values, 1.0), 0.0)
    share = np.minimum(np.sum(parts, axis=1) / np.where(power > 0.0, power, 1.0), 1.0)
    rank = np.count_nonzero(kept, axis=1)
    chance = np.minimum(rank / segments, 0.9)
    return power * (share - chance) / (1.0 - chance), rank


def _spectra(traces: Sequence[Trace], weights: Sequence[Array], errors: Sequence[Array]) -> Spectra:
    """Segments x frequencies x signals; the segments' mean squares add up to the power over frequency."""
    whole = [_signals(*of_one) for of_one in zip(traces, weights, errors, strict=True)]
    signals = [one[trace.lead_blocks :] for one, trace in zip(whole, traces, strict=True)]
    period = traces[0].dt * traces[0].block
    shortest = min(len(s) for s in signals)
    total = sum(len(s) for s in signals)
    length = max(2, min(round(SEGMENT_S / period), shortest, 2 * total // LEAST_SEGMENTS))
    window = np.hanning(length + 1)[:-1]
    cut = []
    for trace, one_signals in zip(traces, signals, strict=True):
        starts = np.arange(0, len(one_signals) - length + 1, max(1, length // 2))
        counts = trace.judged_blocks[trace.lead_blocks :]
        cut += [one_signals[s : s + length] for s in starts if counts[s : s + length].all()]
    if not cut:
        raise BadInputError("no stretch of 2 s is left to judge errors in", fix="record longer")
    spectra = np.fft.rfft(np.stack(cut) * window[:, None], axis=1)
    twice = np.full(spectra.shape[1], 2.0)
    twice[0] = 1.0
    if length % 2 == 0:
        twice[-1] = 1.0
    return np.asarray(spectra * np.sqrt(twice / (float(window @ window) * length))[:, None])


def _signals(trace: Trace, weights: Array, error: Array) -> Array:
    """Weighted errors, weighted simulated channels, request: blocks x 7, 0 where not measured."""
    simulated = np.where(weights > 0, trace.measured * weights - error, 0.0)
    request = blocks(trace.torque[:, None], trace.block)
    return np.column_stack([error, simulated, request])
