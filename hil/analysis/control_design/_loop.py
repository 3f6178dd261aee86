"""The open loop of the wheel speed control: Nyquist, sensitivity, margins, stability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import COMFORT_BAND_HZ
from hil.core.model import TransferFunction

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_FOLDS = 200  # of aliasing: what is left out falls with their number


def loop_grid(sample_time_s: float = 0.001, count: int = 3000) -> Array:
    """Frequencies from 5 mHz to just below half the sampling rate, for a loop's analysis."""
    return np.geomspace(0.005, 0.499 / sample_time_s, count)


def feedback_response(
    blocks: Sequence[TransferFunction], frequency_hz: Array, sample_time_s: float | None
) -> ComplexArray:
    """Response of blocks in series; by Tustin's rule with a sample time, continuous without.

    Tustin's rule is the continuous response at the warped frequency tan(π f T)/(π T).
    """
    frequency = np.asarray(frequency_hz, dtype=float)
    if sample_time_s is not None:
        frequency = np.tan(np.pi * frequency * sample_time_s) / (np.pi * sample_time_s)
    response = np.ones(frequency.shape, complex)
    for block in blocks:
        response = response * block.response(frequency)
    return response


def hold_response(frequency_hz: Array, sample_time_s: float) -> ComplexArray:
    """Zero-order hold: sinc(f T)·exp(-jπ f T). Computing time is part of the model's dead time."""
    x = np.asarray(frequency_hz) * sample_time_s
    return np.asarray(np.sinc(x) * np.exp(-1j * np.pi * x))


def sampled_response(plant: TransferFunction, frequency_hz: Array, sample_time_s: float) -> ComplexArray:
    """The plant as a sampling controller sees it: held, and with what sampling folds back (aliasing).

    The sum over k of P(f + k/T) hold(f + k/T); |k| up to `_FOLDS`, beyond which both have fallen off.
    """
    frequency = np.asarray(frequency_hz, dtype=float)
    total = np.zeros(frequency.shape, complex)
    for fold in range(-_FOLDS, _FOLDS + 1):
        folded = frequency + fold / sample_time_s
        total += plant.response(folded) * hold_response(folded, sample_time_s)
    return total


@dataclass(frozen=True)
class Margins:
    """How far a loop is from instability; infinite where there is no crossing.

    Attributes:
        gain_margin_db: smallest change of gain, up or down, that reaches -1.
        gain_margin_hz: where.
        phase_margin_deg: smallest turn, either way, that reaches -1.
        phase_margin_hz: where.
        delay_margin_s: smallest extra dead time that reaches -1.
        sensitivity_peak: largest |S|.
        sensitivity_peak_hz: where.
        comfort_peak: largest |S| in 8-20 Hz.
        comfort_rms: rms of |S| over 8-20 Hz, linear in frequency.
        stable: by Nyquist's criterion.
    """

    gain_margin_db: float
    gain_margin_hz: float
    phase_margin_deg: float
    phase_margin_hz: float
    delay_margin_s: float
    sensitivity_peak: float
    sensitivity_peak_hz: float
    comfort_peak: float
    comfort_rms: float
    stable: bool


def margins(frequency_hz: Array, loop: ComplexArray, origin_poles: int) -> Margins:
    """Margins of an open loop given on a dense grid from far below to far above its crossovers.

    Args:
        frequency_hz: F frequencies, increasing.
        loop: F values of the open loop.
        origin_poles: poles of the open loop at the origin; it must have none to the right.
    """
    size = np.abs(loop)
    gain_db, gain_hz = _gain_margin(frequency_hz, loop)
    crossings = np.flatnonzero(np.diff(np.sign(np.log(np.maximum(size, 1e-300)))) != 0)
    phase_deg, phase_hz, delay = np.inf, np.nan, np.inf
    for i in crossings:
        share = np.log(size[i]) / (np.log(size[i]) - np.log(size[i + 1]))
        hz = float(frequency_hz[i] + share * (frequency_hz[i + 1] - frequency_hz[i]))
        turn = np.angle(-(loop[i] + share * (loop[i + 1] - loop[i])))
        if abs(np.degrees(turn)) < abs(phase_deg):
            phase_deg, phase_hz = float(abs(np.degrees(turn))), hz
        delay = min(delay, float(np.mod(turn, 2 * np.pi)) / (2 * np.pi * hz))
    sensitivity = 1 / np.maximum(np.abs(1 + loop), 1e-300)
    peak = int(np.argmax(sensitivity))
    comfort_peak, comfort_rms = comfort(frequency_hz, sensitivity)
    return Margins(
        gain_db,
        gain_hz,
        phase_deg,
        phase_hz,
        delay,
        float(sensitivity[peak]),
        float(frequency_hz[peak]),
        comfort_peak,
        comfort_rms,
        bool(encirclements(loop, origin_poles) == 0),
    )


def comfort(frequency_hz: Array, sensitivity: Array) -> tuple[float, float]:
    """Largest and rms |S| over the comfort band, both edges interpolated in."""
    low, high = COMFORT_BAND_HZ
    inside = frequency_hz[(frequency_hz > low) & (frequency_hz < high)]
    grid = np.concatenate([[low], inside, [high]])
    values = np.interp(grid, frequency_hz, sensitivity)
    return float(np.max(values)), float(np.sqrt(np.trapezoid(values**2, grid) / (high - low)))


def encirclements(loop: ComplexArray, origin_poles: int) -> npt.NDArray[np.int64] | int:
    """Unstable closed-loop poles by the argument principle, for loops along the last axis.

    1 + L turns by origin_poles·90° from 0+ to infinity when the closed loop is stable, and by 180° less
    for each unstable pole (the two half axes together count each once).
    """
    around = 1 + loop
    turn = np.sum(np.angle(around[..., 1:] / around[..., :-1]), axis=-1)
    # A pole that is slow but not at the origin turns below the grid: what the asymptote at 0+ tells.
    before = np.angle(around[..., 0] * np.exp(0.5j * np.pi * origin_poles))
    turn = np.where(np.isfinite(turn + before), turn + before, -np.pi)
    missing = np.rint((origin_poles * np.pi / 2 - turn) / np.pi).astype(np.int64)
    return int(missing) if np.ndim(missing) == 0 else missing


def _gain_margin(frequency_hz: Array, loop: ComplexArray) -> tuple[float, float]:
    best_db, best_hz = np.inf, np.nan
    imaginary = loop.imag
    for i in np.flatnonzero(np.sign(imaginary[:-1]) != np.sign(imaginary[1:])):
        share = imaginary[i] / (imaginary[i] - imaginary[i + 1])
        real = float(loop[i].real + share * (loop[i + 1].real - loop[i].real))
        if real >= 0:
            continue
        change = abs(20 * np.log10(-real))
        if change < best_db:
            best_db, best_hz = change, float(frequency_hz[i] + share * np.diff(frequency_hz)[i])
    return float(best_db), float(best_hz)
