"""What noise each channel is proven to have: by its spectrum, its rounding, its rests, its maker."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._series import Series
from hil.analysis.power_density import power_density
from hil.core.channels import OUTPUTS

Array = npt.NDArray[np.float64]

_TOP = 0.6  # of the band up to half the rate: above it stands no mode of a driveline, only noise
_WINDOW = 1024  # samples
_DIGITS = 1e-5  # of a channel's rms: what no instrument of a bench resolves


def proven_noise(series: Sequence[Series], stated: Mapping[str, float]) -> Array:
    """Standard deviation of a block mean's noise in each channel, shape (3,); NaN where none was recorded.

    The largest of: white noise by the top of the spectrum, rounding by the distance of readings, what the
    user or a data sheet states (of a sample), and the last digit of any instrument.
    """
    levels = np.full(len(OUTPUTS), np.nan)
    for column, name in enumerate(OUTPUTS):
        have = [one for one in series if one.has[column]]
        if not have:
            continue
        white = np.median([_white_of_blocks(one, column) for one in have])
        step = rounding_step(np.concatenate([one.samples[:, column] for one in have]))
        maker = stated.get(name, 0.0) / np.sqrt(have[0].block)
        digits = _DIGITS * np.sqrt(np.mean([np.mean(one.samples[:, column] ** 2) for one in have]))
        levels[column] = max(float(white), step / np.sqrt(12.0), maker, float(digits), 1e-12)
    return levels


def _white_of_blocks(one: Series, column: int) -> float:
    """White noise of block means: by readings; where samples lie between these, by the means."""
    if one.even:
        return _white(one.samples[:, column]) / float(np.sqrt(one.block))
    return _white(one.measured[:, column])


def _white(values: Array) -> float:
    """Standard deviation of a sample, by the median density above `_TOP` of the band (lines left out)."""
    frequency, density = power_density(values[:, None], 1.0, min(_WINDOW, len(values)), average="median")
    return float(np.sqrt(0.5 * np.median(density[frequency > 0.5 * _TOP, 0])))


def rounding_step(values: Array) -> float:
    """Distance between the readings that a channel takes, in its unit; 0.0 where they are a continuum.

    Readings lie on a grid where there are far fewer levels than samples and nearly all differences of
    neighbouring levels are whole multiples of the smallest usual one.
    """
    levels = np.unique(values)
    if len(levels) < 3 or 4 * len(levels) > len(values):
        return 0.0
    gaps = np.diff(levels)
    step = float(np.median(gaps[gaps <= 1.5 * np.quantile(gaps, 0.1)]))
    off = np.abs(gaps / step - np.rint(gaps / step))
    return step if np.mean(off < 0.05) > 0.9 else 0.0
