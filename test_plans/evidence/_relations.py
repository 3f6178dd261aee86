"""What the drive train demands of its channels, with no model but the gear.

Each relation compares a channel with what its neighbours say that it must be, by the slope of the straight
line through zero over tapered means of half a second: vibration, noise and dead time have no part in it. The
bounds tell a dead, half, mirrored or swapped sensor from drag, efficiency, slip and the rotor's inertia, and
nothing finer.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array

_MEAN_S = 0.5
_LEAST_SHARE = 0.05  # of the largest value: what is left of a vibration in a mean says nothing
_LEAST_MEANS = 4


@dataclass(frozen=True)
class Means:
    """Tapered means over half a second of each channel, and its largest magnitude."""

    values: Mapping[str, Array]
    largest: Mapping[str, float]

    def __getitem__(self, channel: str) -> Array:
        return self.values[channel]

    def __contains__(self, channel: str) -> bool:
        return channel in self.values

    def steady(self, channel: str) -> float:
        """Largest magnitude of a channel's means."""
        means = self.values[channel]
        return float(np.max(np.abs(means), where=np.isfinite(means), initial=0.0))


@dataclass(frozen=True)
class Relation:
    """A channel against its neighbours.

    Attributes:
        channel: what is proven.
        against: channels that it is compared with; they are as doubtful as it is where they disagree.
        law: in words, for docs and messages.
        expected: what the neighbours say that it must be, from means of channels and the segment; None
            where something that it needs is not known.
        within: smallest and largest slope.
        least: root mean square of what is expected, in the channel's unit, below which nothing is proven.
    """

    channel: str
    against: tuple[str, ...]
    law: str
    expected: Callable[[Means, Segment], Array | None]
    within: tuple[float, float]
    least: float

    def objection(self, means: Means, segment: Segment) -> str:
        """How the channel contradicts its neighbours; '' where it agrees, or where nothing can be said."""
        if self.channel not in means or any(name not in means for name in self.against):
            return ""
        if any(means.largest[name] * _LEAST_SHARE > means.steady(name) for name in self.against):
            return ""
        expected, found = self.expected(means, segment), means[self.channel]
        if expected is None:
            return ""
        known = np.isfinite(expected) & np.isfinite(found)
        expected, found = expected[known], found[known]
        if len(expected) < _LEAST_MEANS or np.sqrt(np.mean(expected**2)) < self.least:
            return ""
        slope = float(expected @ found / (expected @ expected))
        if self.within[0] <= slope <= self.within[1]:
            return ""
        return (
            f"{self.channel} is {slope:.3g} times what {' and '.join(self.against)} demands ({self.law}), "
            f"{self.within[0]:g} to {self.within[1]:g} would agree: a sensor is dead, scaled or swapped, or "
            "the gear ratio or radius is wrong"
        )


def _by_gear(motor: str, *, up: bool) -> Callable[[Means, Segment], Array | None]:
    def expected(means: Means, segment: Segment) -> Array | None:
        ratio = segment.gear_ratio
        return None if ratio is None else means[motor] * (ratio if up else 1 / ratio)

    return expected


def _own(channel: str) -> Callable[[Means, Segment], Array | None]:
    return lambda means, segment: means[channel]


def _rolling(means: Means, segment: Segment) -> Array | None:
    radius_m = segment.rolling_radius_m
    return None if radius_m is None else means["wheel_speed_rad_s"] * radius_m


_SPEED, _SIDES, _TORQUE, _SLIP = (0.95, 1.05), (0.6, 1.67), (0.75, 1.25), (0.8, 1.2)
_LEAST_SPEED_RAD_S, _LEAST_SPEED_M_S, _LEAST_TORQUE_NM = 0.5, 0.2, 20.0

RELATIONS = (
    Relation(
        "wheel_speed_rad_s",
        ("motor_speed_rad_s",),
        "ω_l = ω_m / N",
        _by_gear("motor_speed_rad_s", up=False),
        _SPEED,
        _LEAST_SPEED_RAD_S,
    ),
    Relation(
        "motor_speed_rad_s",
        ("wheel_speed_rad_s",),
        "ω_m = N ω_l",
        _by_gear("wheel_speed_rad_s", up=True),
        _SPEED,
        8 * _LEAST_SPEED_RAD_S,
    ),
    Relation(
        "wheel_speed_left_rad_s",
        ("wheel_speed_right_rad_s",),
        "left = right",
        _own("wheel_speed_right_rad_s"),
        (0.9, 1.1),
        _LEAST_SPEED_RAD_S,
    ),
    Relation(
        "vehicle_speed_m_s",
        ("wheel_speed_rad_s",),
        "V̂ = r ω_l (1 - slip)",
        _rolling,
        _SLIP,
        _LEAST_SPEED_M_S,
    ),
    Relation(
        "shaft_torque_nm",
        ("motor_torque_nm",),
        "T_s = N T_m",
        _by_gear("motor_torque_nm", up=True),
        _TORQUE,
        _LEAST_TORQUE_NM,
    ),
    Relation(
        "shaft_torque_left_nm",
        ("shaft_torque_right_nm",),
        "left = right, as a differential demands",
        _own("shaft_torque_right_nm"),
        _SIDES,
        0.5 * _LEAST_TORQUE_NM,
    ),
    Relation(
        "shaft_torque_right_nm",
        ("shaft_torque_left_nm",),
        "left = right, as a differential demands",
        _own("shaft_torque_left_nm"),
        _SIDES,
        0.5 * _LEAST_TORQUE_NM,
    ),
)


def means_of(recording: Recording, segment: Segment) -> Means:
    """Means of every channel that a relation needs, within a segment."""
    wanted = dict.fromkeys(name for one in RELATIONS for name in (one.channel, *one.against))
    names = [name for name in wanted if name in recording]
    if not names or recording.samples < 2:
        return Means({}, {})
    first, last = (recording.rows_before(time_s) for time_s in (segment.start_s, segment.end_s))
    rows = recording.rows(first, last, names)
    length = max(1, round(_MEAN_S / recording.sample_time_s))
    whole = (last - first) // length * length
    blocks = {name: rows[name][:whole] for name in names}
    largest = {
        name: float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))
        for name, values in blocks.items()
    }
    return Means({name: _means(values, length) for name, values in blocks.items()}, largest)


def _means(values: Array, length: int) -> Array:
    """Of each block, weighted by a Hann window; NaN where half of its weight or more is missing."""
    blocks = values.reshape(-1, length)
    taper = 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(length) + 0.5) / length)
    weights = np.where(np.isfinite(blocks), taper, 0.0)
    total = np.sum(weights, axis=1)
    sums = np.sum(np.where(weights > 0, blocks, 0.0) * weights, axis=1)
    return np.where(2 * total > np.sum(taper), sums / np.maximum(total, 1e-300), np.nan)
