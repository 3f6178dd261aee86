"""What noise each channel is proven to have: by its spectrum, its rounding, its rests, its maker."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._series import Series
from hil.analysis.missing_effects._spectrum import bands_of, edges_hz
from hil.analysis.power_density import bias_of_median, power_density
from hil.core.channels import ANGLES, OUTPUTS
from hil.plant import GEAR_RATIO, followed, half_window, rounding_step

Array = npt.NDArray[np.float64]

SHAFT = OUTPUTS[2]

_TOP = 0.6  # of the band up to half the rate: above it stands no mode of a driveline, only noise
_TOP_SLOPE = float(2.0 * np.sin(0.25 * np.pi * (1.0 + _TOP)))  # of differences of white noise, over it, there
_LATE_S, _MOST_LAGS = 0.03, 60  # at most is a torque that leaps along; samples
_SOME = 40_000  # samples
_WINDOW, _WINDOWS = 1024, 8  # samples at most; windows at least
_BINS = 4096  # of a spectrum of noise
_LEAST_COLOUR = 1e-4  # no encoder's noise is that much less in one octave than in all
_DIGITS = 1e-5  # of a channel's rms: what no instrument of a bench resolves


def proven_noise(series: Sequence[Series], stated: Mapping[str, float]) -> Array:
    """Standard deviation of a block mean's noise in each channel, shape (3,); NaN where none was recorded.

    The largest of: white noise by the top of the spectrum, rounding by the distance of readings, what the
    user or a data sheet states (of a sample), and the last digit of any instrument.
    """
    levels = np.full(len(OUTPUTS), np.nan)
    for column, name in enumerate(OUTPUTS):
        have = [one for one in series if np.isfinite(one.samples[0, column])]
        if not have:
            continue
        if any(one.of_angle[column] for one in have):
            levels[column] = _of_angles(have, column, stated.get(ANGLES[name], 0.0))
            continue
        white = np.median([_white_of_blocks(one, column) for one in have])
        if name == SHAFT:  # a rigid axle's leaps with the torque, whose steps are no noise
            white = min(white, np.median([_white_beside_torque(one) for one in have]))
        step = rounding_step(np.concatenate([one.samples[:, column] for one in have]))
        maker = stated.get(name, 0.0) / np.sqrt(np.median([one.block for one in have]))
        digits = _DIGITS * np.sqrt(np.mean([np.mean(one.samples[:, column] ** 2) for one in have]))
        levels[column] = max(float(white), step / np.sqrt(12.0), maker, float(digits), 1e-12)
    return levels


def _of_angles(series: Sequence[Series], column: int, stated_rad: float) -> float:
    """Of block means of what an angle turns by, by the white noise of its readings and their rounding."""
    have = [one for one in series if one.of_angle[column]]
    angles = [one.angle[:, column] for one in have]
    white = np.median([white_level(np.diff(one)) for one in angles]) / _TOP_SLOPE
    step = rounding_step(np.concatenate(angles), often=False)
    digits = 1e-15 * max(float(np.max(np.abs(one))) for one in angles)
    of_a_reading = max(float(white), step / np.sqrt(12.0), stated_rad, digits)
    return float(of_a_reading * np.sqrt(_together(have[0])[0]))


def colour_of(series: Sequence[Series]) -> Array | None:
    """Power of each channel's noise by octave (3 x bands), over its mean; None where all are white.

    That of what an angle turns by rises with the frequency: an angle does not walk off.
    """
    one = next((one for one in series if one.of_angle.any()), None)
    if one is None:
        return None
    edges = edges_hz(series[0].rate_hz)
    colour = np.ones((len(OUTPUTS), len(edges) - 1))
    together = _together(one)
    frequency = np.linspace(0.0, 0.5 * one.rate_hz, _BINS)
    waves = np.cos(2.0 * np.pi * frequency[:, None] * np.arange(len(together)) / one.rate_hz)
    power = (2.0 * waves @ together - together[0]) / together[0]
    band = bands_of(edges, frequency)
    count = np.bincount(band, minlength=len(edges) - 1)
    octaves = np.bincount(band, power, len(edges) - 1) / np.maximum(count, 1)
    colour[one.of_angle] = np.maximum(octaves, _LEAST_COLOUR)
    return colour


def with_motion(
    noise: Array, colour: Array | None, series: Sequence[Series], slots: Array
) -> tuple[Array, Array]:
    """Noise (3,) and its colour (3 x bands) with that of recorded turning, as a packed model shows it."""
    one = series[0]
    edges = edges_hz(one.rate_hz)
    frequency: Array = (np.arange(one.block * _BINS, dtype=np.float64) + 0.5) / (
        2 * one.block * _BINS * one.dt
    )
    mean = np.sin(np.pi * frequency * one.block * one.dt) / (one.block * np.sin(np.pi * frequency * one.dt))
    turning = one.turning(float(slots[GEAR_RATIO])).noise_at(frequency)
    square = turning * np.square(followed(slots, frequency) * mean) / one.block
    # of means of blocks what is faster than half their rate looks slow
    folded = np.abs((frequency + 0.5 * one.rate_hz) % one.rate_hz - 0.5 * one.rate_hz)
    band = bands_of(edges, folded)
    count = np.maximum(np.bincount(band, minlength=len(edges) - 1), 1) / one.block
    octaves = np.stack([np.bincount(band, row, len(edges) - 1) / count for row in square])
    own = noise[:, None] ** 2 * (np.ones(octaves.shape) if colour is None else colour)
    level = noise**2 + one.block * square.mean(axis=1)
    there = np.isfinite(noise)[:, None]  # a channel that is not compared has no colour
    return np.sqrt(level), np.where(there, (own + octaves) / level[:, None], 1.0)


def _together(one: Series) -> Array:
    """Covariances of block means so many blocks apart of what an angle with white noise of one turns by."""
    half, block = half_window(one.dt), one.block
    weights = np.zeros(block + 2 * half)
    weights[2 * half :] += 1.0
    weights[:block] -= 1.0
    weights /= block * 2 * half * one.dt
    apart = range(0, len(weights), block)
    return np.array([float(weights[at:] @ weights[: len(weights) - at]) for at in apart])


def _white_beside_torque(one: Series) -> float:
    """White noise of block means of the shaft torque, without what leaps along with the torque asked for."""
    some = slice(_SOME)  # of a long recording as many as tell it
    leaps, asked = np.diff(one.samples[some, OUTPUTS.index(SHAFT)]), np.diff(one.torque[some])
    lags = min(round(_LATE_S / one.dt), _MOST_LAGS, len(leaps) // 10)
    late = np.stack([np.concatenate([np.zeros(k), asked[: len(asked) - k]]) for k in range(lags)], axis=1)
    rest = leaps - late @ np.linalg.lstsq(late.T @ late, late.T @ leaps, rcond=None)[0]
    return white_level(rest) / _TOP_SLOPE / float(np.sqrt(one.block))


def _white_of_blocks(one: Series, column: int) -> float:
    """White noise of block means: by readings; where samples lie between these, by the means."""
    if one.even:
        return white_level(one.samples[:, column]) / float(np.sqrt(one.block))
    return white_level(one.measured[:, column])


def white_level(values: Array) -> float:
    """Standard deviation of a sample, by the median density above `_TOP` of the band (lines left out)."""
    length = min(_WINDOW, max(len(values) // _WINDOWS, 2))
    frequency, density = power_density(values[:, None], 1.0, length, average="median")
    windows = 1 + (len(values) - length) // (length - length // 2)
    # a median of any number has the median of one as its own: log 2 of the mean
    typical = np.median(density[frequency > 0.5 * _TOP, 0]) * bias_of_median(windows) / np.log(2.0)
    return float(np.sqrt(0.5 * typical))
