"""Ride comfort: frequency-weighted acceleration along the vehicle, by ISO 2631-1: its mean and its blows."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from hil.core.runtime.compiled import compiled
from test_plans.conductor import Array
from test_plans.metrics._low_pass import periodogram
from test_plans.metrics._metric import ChannelName, NoValueError
from test_plans.metrics._samples import cut, evenly
from test_plans.metrics._window import WindowMetric

_LEAST_RATE_HZ = 200.0  # what is weighted reaches to 100 Hz
_LOWEST_HZ, _HIGHEST_HZ = 0.4, 100.0
_LEAST_S = (
    1 / _LOWEST_HZ
)  # shorter than a period of the lowest, the window's trend takes what is weighted with it
_TRANSITION_HZ, _TRANSITION_Q = 2.0, 0.63
_LEAST_BEFORE_S = 0.2  # in less no acceleration shows
Section = tuple[float, float, float]


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
        start_s, end_s = self.bounds_s(recording, segment)
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


class VibrationDose(WindowMetric):
    """Fourth-power vibration dose value of the vehicle's longitudinal acceleration: sensitive to blows.

    V̂ is differentiated and weighted in one filter, Tustin's rule at the recording's rate. The acceleration
    before the step counts as if it had been there for ever.
    """

    name: ClassVar[str] = "vibration_dose"
    never_negative: ClassVar[bool] = True
    channel: ChannelName = "vehicle_speed_m_s"

    @property
    def unit(self) -> str:
        """That of a dose."""
        return "m/s^1.75"

    @property
    def definition(self) -> str:
        """How the speed becomes a dose."""
        return (
            f"Vibration dose value of ISO 2631-1:1997 (6.3.2): {self.subject} {self.window}, differentiated "
            "and weighted by W_d (horizontal, seated person) as a filter in time; the fourth root of the "
            f"integral of the fourth power. The acceleration before {self._origin} is taken as constant. "
            "The speed is that of the dyno controller's vehicle model, without seat and body: to compare "
            "controllers by."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Fourth root of the sum of fourth powers times the sample time."""
        start_s, end_s = self.bounds_s(recording, segment)
        time, values = cut(recording, segment, self.channel, min(segment.start_s, start_s), end_s)
        spacing, even = evenly(time, values)
        if 1 / spacing < _LEAST_RATE_HZ - 1e-6:
            raise NoValueError(f"{1 / spacing:.4g} samples a second do not reach {_HIGHEST_HZ:g} Hz")
        grid: Array = spacing * np.arange(len(even), dtype=float)
        before = even[grid <= self.origin_s(segment) - time[0] + 0.5 * spacing]
        weighted: Array = even - _line_before(before, spacing, grid)
        for b, a in weighting_sections(spacing):
            _filter(weighted, np.array(b), np.array(a))
        inside = grid >= start_s - time[0] - 0.5 * spacing
        return float((np.sum(weighted[inside] ** 4) * spacing) ** 0.25)


def weighting_sections(spacing_s: float) -> list[tuple[Section, Section]]:
    """Numerators and denominators in z^-1 of s W_d(s) by Tustin's rule: three sections of second order."""
    low, high, middle = (2 * np.pi * f for f in (_LOWEST_HZ, _HIGHEST_HZ, _TRANSITION_HZ))
    root = np.sqrt(2.0)
    analogue = [
        ((1.0, 0.0, 0.0), (1.0, root * low, low**2)),
        ((0.0, high**2, 0.0), (1.0, root * high, high**2)),
        ((0.0, middle, middle**2), (1.0, middle / _TRANSITION_Q, middle**2)),
    ]
    return [_tustin(b, a, 2 / spacing_s) for b, a in analogue]


def _tustin(b: Section, a: Section, rate: float) -> tuple[Section, Section]:
    """From powers of s to powers of 1/z; a_0 is 1."""

    def turned(p: Section) -> Section:
        square, line, constant = p[0] * rate**2, p[1] * rate, p[2]
        return square + line + constant, 2 * (constant - square), square - line + constant

    above, below = turned(b), turned(a)
    first = below[0]
    return (above[0] / first, above[1] / first, above[2] / first), (1.0, below[1] / first, below[2] / first)


def _line_before(before: Array, spacing_s: float, grid: Array) -> Array:
    """The speed as it would have gone on without the step: a straight line through what is before it."""
    if len(before) * spacing_s < _LEAST_BEFORE_S:
        return np.full(len(grid), before[0] if len(before) else 0.0)
    place = np.arange(len(before)) * spacing_s
    middle = float(np.mean(place))
    slope = float((place - middle) @ before / ((place - middle) @ (place - middle)))
    return np.asarray(float(np.mean(before)) + slope * (grid - middle))


@compiled
def _filter(x, b, a):  # type: ignore[no-untyped-def]
    """One section in place, from rest."""
    first = 0.0
    second = 0.0
    for i in range(x.shape[0]):
        y = b[0] * x[i] + first
        first = b[1] * x[i] - a[1] * y + second
        second = b[2] * x[i] - a[2] * y
        x[i] = y


def horizontal_weighting(frequency_hz: Array) -> Array:
    """Magnitude of W_d (ISO 2631-1:1997, annex A), of the shape of `frequency_hz`; at 1 Hz it is 1.011."""
    f = np.asarray(frequency_hz, dtype=float)
    high_pass = f**2 / np.sqrt(f**4 + _LOWEST_HZ**4)  # two poles each, Q = 1/√2
    low_pass = _HIGHEST_HZ**2 / np.sqrt(f**4 + _HIGHEST_HZ**4)
    ratio = 1j * f / _TRANSITION_HZ
    transition = np.abs((1 + ratio) / (1 + ratio / _TRANSITION_Q + ratio**2))
    return np.asarray(high_pass * low_pass * transition)
