"""What stands between a quantity and its channel: low-pass, lateness, gain, offset, rounding; and noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline
from scipy.signal import bilinear, lfilter, lfilter_zi

Array = npt.NDArray[np.float64]


_FINER = 10  # times as fine as the samples: where the low-pass is worked out


@dataclass(frozen=True)
class Sensor:
    """Errors of one channel: reading = gain·truth(t - delay_s) + offset + drift, then rounded to `step`.

    With a `lag_s` the truth passes a first-order low-pass of that time constant first.

    The drift swings by `drift` about a value of its own and is zero when a recording begins.
    """

    channel: str
    gain: float = 1.0
    offset: float = 0.0
    delay_s: float = 0.0
    step: float = 0.0
    lag_s: float = 0.0
    drift: float = 0.0
    drift_period_s: float = 60.0
    drift_phase_rad: float = 0.0

    def read(self, truth: Array, sample_s: float) -> Array:
        """The reading before rounding; the first value stands for the time before the recording."""
        time_s = np.arange(len(truth)) * sample_s
        if self.drift != 0.0:
            swing = np.sin(2.0 * np.pi * time_s / self.drift_period_s + self.drift_phase_rad)
            truth = truth + self.drift * (swing - swing[0]) / self.gain
        if self.lag_s > 0.0:
            truth = low_passed(truth, self.lag_s, sample_s)
        if self.delay_s == 0.0:
            return self.gain * truth + self.offset
        late = np.clip(time_s - self.delay_s, 0.0, time_s[-1])
        return self.gain * CubicSpline(time_s, truth)(late) + self.offset

    def rounded(self, reading: Array) -> Array:
        return np.round(reading / self.step) * self.step if self.step > 0.0 else reading


def low_passed(truth: Array, lag_s: float, sample_s: float) -> Array:
    """What a first-order low-pass makes of `truth`, which stood still before: Tustin on a spline."""
    samples = np.arange(len(truth), dtype=float)
    fine = CubicSpline(samples, truth)(np.arange((len(truth) - 1) * _FINER + 1) / _FINER)
    forward, back = bilinear([1.0], [lag_s, 1.0], _FINER / sample_s)
    out, _ = lfilter(forward, back, fine, zi=lfilter_zi(forward, back) * fine[0])
    return np.asarray(out[::_FINER], dtype=float)


def coloured_noise(
    rng: np.random.Generator,
    samples: int,
    deviation: float,
    *,
    share: float,
    corner_hz: float,
    rate_hz: float,
) -> Array:
    """Noise of standard deviation `deviation`: white, `share` of its variance low-passed at `corner_hz`."""
    pole = np.exp(-2.0 * np.pi * corner_hz / rate_hz)
    slow = lfilter([np.sqrt(1.0 - pole**2)], [1.0, -pole], rng.standard_normal(samples + 2000))[2000:]
    white = rng.standard_normal(samples)
    return np.asarray(deviation * (np.sqrt(1.0 - share) * white + np.sqrt(share) * slow))
