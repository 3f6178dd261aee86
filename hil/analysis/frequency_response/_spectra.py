"""Fourier lines of an experiment, scaled so that experiments of any length and rate can be put together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft

from hil.analysis.frequency_response._experiment import Experiment

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Lines:
    """Fourier lines of one experiment between two frequencies.

    `input`, `reference` (L) and `output_rate` (O x L) are Fourier transforms divided by the square root
    of the duration, so that their squared magnitude is a two-sided power spectral density.
    `output_rate` is the output times jω: what is fitted is jω·G, then divided by jω again.
    """

    frequency_hz: Array
    input: ComplexArray
    output_rate: ComplexArray
    reference: ComplexArray | None


def fourier_lines(experiment: Experiment, from_hz: float, to_hz: float) -> Lines:
    """Lines from `from_hz` to `to_hz` (ends included, zero frequency never).

    Outputs are differenced before the transform and the difference is divided out exactly: an axle
    integrates torque to speed, and without this the speed gained over the record would leak over all
    low frequencies. The input is delayed by half its hold time, which is what a zero-order hold does
    well below the sampling rate; so the hold is not counted as dead time of the plant.
    """
    step = experiment.sample_time_s
    count = int(fft.prev_fast_len(len(experiment.input) - 1, real=True))
    frequency = np.arange(count // 2 + 1) / (count * step)
    wanted = (frequency >= from_hz) & (frequency <= to_hz) & (frequency > 0)
    frequency = frequency[wanted]
    scale = step / np.sqrt(count * step)
    s = 2j * np.pi * frequency

    def lines(values: Array) -> ComplexArray:
        return np.asarray(fft.rfft(values, axis=-1)[..., wanted] * scale)

    difference = np.diff(experiment.outputs, axis=1)[:, :count]
    first = slice(1, count + 1)
    return Lines(
        frequency,
        lines(experiment.input[first]) * np.exp(-0.5 * experiment.hold_s * s),
        lines(difference) * (s / -np.expm1(-s * step)),
        None if experiment.reference is None else lines(experiment.reference[first]),
    )
