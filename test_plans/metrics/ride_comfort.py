"""Ride comfort: frequency-weighted acceleration along the vehicle, by ISO 2631-1."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array
from test_plans.metrics._metric import ChannelName, NoValueError
from test_plans.metrics._periodogram import periodogram
from test_plans.metrics._window import WindowMetric, cut

_LEAST_RATE_HZ = 200.0  # what is weighted reaches to 100 Hz
_LOWEST_HZ, _HIGHEST_HZ = 0.4, 100.0
_LEAST_S = (
    1 / _LOWEST_HZ
)  # shorter than a period of the lowest, the window's trend takes what is weighted with it
_TRANSITION_HZ, _TRANSITION_Q = 2.0, 0.63


class RideComfort(WindowMetric):
    """Weighted r.m.s. longitudinal acceleration of the vehicle, W_d of ISO 2631-1; lower is better."""

    name: ClassVar[str] = "ride_comfort"
    never_negative: ClassVar[bool] = True
    channel: ChannelName = "vehicle_speed_m_s"

    @property
    def unit(self) -> str:
        """That of an acceleration."""
        return "m/s²"

    @property
    def definition(self) -> str:
        """How the speed becomes a weighted acceleration."""
        return (
            f"{self.subject} {self.window} (the sample at the end left out): linear trend removed, Hann "
            "window, one-sided power spectral density, times (2πf)² and the square of the weighting W_d of "
            "ISO 2631-1:1997 (horizontal, seated person), summed over all lines; the square root of it. "
            "Constant acceleration does not count. The speed is that of the dyno controller's vehicle model, "
            "without seat and body: to compare controllers by, not to state an exposure."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Root of the sum of weighted density times line spacing (Parseval)."""
        start_s, end_s = self.bounds_s(segment)
        time, values = cut(recording, segment, self.channel, start_s, end_s, with_end=False)
        if end_s - start_s < _LEAST_S - 1e-9:
            raise NoValueError(f"{end_s - start_s:.4g} s do not hold a period of {_LOWEST_HZ:g} Hz")
        count = round((end_s - start_s) / recording.sample_time_s)
        spacing = (end_s - start_s) / count
        if 1 / spacing < _LEAST_RATE_HZ - 1e-6:
            raise NoValueError(f"{1 / spacing:.4g} samples a second do not reach {_HIGHEST_HZ:g} Hz")
        even = np.interp(start_s + spacing * np.arange(count), time, values)
        frequency, density = periodogram(even, spacing)
        weighted = density * (2 * np.pi * frequency * horizontal_weighting(frequency)) ** 2
        return float(np.sqrt(np.sum(weighted) / (end_s - start_s)))


def horizontal_weighting(frequency_hz: Array) -> Array:
    """Magnitude of W_d (ISO 2631-1:1997, annex A), of the shape of `frequency_hz`; at 1 Hz it is 1.011."""
    f = np.asarray(frequency_hz, dtype=float)
    high_pass = f**2 / np.sqrt(f**4 + _LOWEST_HZ**4)  # two poles each, Q = 1/√2
    low_pass = _HIGHEST_HZ**2 / np.sqrt(f**4 + _HIGHEST_HZ**4)
    ratio = 1j * f / _TRANSITION_HZ
    transition = np.abs((1 + ratio) / (1 + ratio / _TRANSITION_Q + ratio**2))
    return np.asarray(high_pass * low_pass * transition)
