"""How far coloured errors may pull a fit's numbers, from the spectrum of those that are left.

Stretches of a few seconds (see `_covariance`) tell too little where a number shows in few of them: a limit
that is reached twice is pulled in two stretches, and a fit has made these two pulls sum up to nothing. The
spectrum is known from all of a recording, and says what errors of its kind would do there (the covariance of
least squares under stationary errors; E. J. Hannan, Multiple Time Series, 1970, ch. VII). Towards the slowest
errors it falls only because initial values and losses have been fitted to them: it is taken not to.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.thresholds import FALLS_NOT, LEAST_LINES, SMOOTHED

Array = npt.NDArray[np.float64]


def coloured_spread(of_recordings: Sequence[Errors]) -> Array:
    """Covariance of the gradient of the sum of squared errors: coordinates x coordinates."""
    longest = max(len(one.channels) for one in of_recordings)
    length = 1 << (2 * longest - 1).bit_length()  # twice as long: a transform knows no end
    slopes = [one.slopes.reshape(*one.channels.shape, one.by_coordinate.shape[1]) for one in of_recordings]
    twice = np.full(length // 2 + 1, 2.0)  # a real signal's lines stand for two each, but for the outermost
    twice[[0, -1]] = 1.0
    total = np.zeros((slopes[0].shape[2],) * 2)
    for channel in range(3):
        power = _power([one.channels[:, channel] for one in of_recordings], length)
        slow = 1 + FALLS_NOT * length // longest
        power[:slow] = np.maximum(power[:slow], power[slow // 2 : 2 * slow].mean())
        for each in slopes:
            lines = np.fft.rfft(each[:, channel], length, axis=0)
            total += np.real((lines.conj() * (power * twice)[:, None]).T @ lines) / length
    return total


def _power(rows: Sequence[Array], length: int) -> Array:
    """Spectrum of what is left in a channel, over all recordings: 1 throughout for white noise."""
    counted = sum(np.count_nonzero(one) for one in rows)
    raw = np.sum([np.abs(np.fft.rfft(one, length)) ** 2 for one in rows], axis=0) / max(counted, 1)
    line = np.arange(len(raw))
    first = np.clip(np.minimum(line / SMOOTHED, line - LEAST_LINES), 0, None).astype(int)
    last = np.minimum(np.maximum(line * SMOOTHED, line + LEAST_LINES).astype(int), len(raw) - 1) + 1
    below = np.concatenate([[0.0], np.cumsum(raw)])
    return np.asarray((below[last] - below[first]) / (last - first))
