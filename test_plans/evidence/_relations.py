"""What the drive train demands of its channels, with no model but the gear.

Each relation compares a channel with what its neighbours say that it must be, by the slope of the straight
line through zero over tapered means of half a second: vibration, noise and dead time have no part in it.
Where such means show too little, as under a multisine, means of a tenth of a second show whether a channel
is dead. Without a known gear ratio, that of the measured speeds is taken. The bounds tell a dead, half,
mirrored or swapped sensor from drag, efficiency, slip and the rotor's inertia, and nothing finer.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array
from test_plans.metrics import hann

_MEAN_S, _SHORTEST_MEAN_S, _SHORT_MEAN_S = 0.5, 0.25, 0.1
_NOTHING = 0.02  # slope of a dead channel
_AT_REST = 0.6  # of the friction that may be missing
_SHORT_LEAST = 0.2  # of `least`, of short means
_LEAST_SHARE = 0.05  # of the largest value: what is left of a vibration in a mean says nothing
_LEAST_MEANS = 4
_LEAST_S = _LEAST_MEANS * _MEAN_S  # looked at: the end, and what came before a shorter segment


@dataclass(frozen=True)
class Means:
    """Tapered means of each channel and its largest magnitude, gear ratio and radius as far as known.

    `stated_ratio` is a gear ratio that the segment states: not one made of the speeds.
    """

    values: Mapping[str, Array]
    largest: Mapping[str, float]
    gear_ratio: float | None
    rolling_radius_m: float | None
    stated_ratio: float | None = None

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
        expected: what the neighbours say that it must be, from means of channels; None
            where something that it needs is not known.
        within: smallest and largest slope.
        why: what may be wrong where they disagree.
        shaken: smallest and largest slope over short means, in which vibration has a part; None: they say
            nothing.
        beside: what may differ at every value, in the channel's unit: friction, or what the twist of a shaft
            or a tyre makes of a speed.
        least: root mean square of what is expected, in the channel's unit, below which nothing is proven.
        otherwise: what it may be as well; None: nothing.
    """

    channel: str
    against: tuple[str, ...]
    law: str
    expected: Callable[[Means], Array | None]
    within: tuple[float, float]
    least: float
    why: str
    shaken: tuple[float, float] | None = None
    beside: float = 0.0
    otherwise: Callable[[Means], Array | None] | None = None

    @property
    def channels(self) -> tuple[str, ...]:
        """All that it compares."""
        return (self.channel, *self.against)

    def objection(self, means: Means, short: Means) -> str:
        """How the channel contradicts its neighbours; '' where it agrees, or where nothing can be stated.

        Args:
            means: over half a second each.
            short: over a tenth of a second each.
        """
        pairs = self._pairs(means, self.least)
        if pairs is not None:
            slope = _slope(*pairs)
            agrees = self._within(slope) or self._differs_by_no_more(*pairs) or self._is_otherwise(means)
            return "" if agrees else self._in_words(slope, self.within)
        pairs = self._pairs(short, _SHORT_LEAST * self.least)
        if pairs is None or self.shaken is None:
            return ""
        slope = _slope(*pairs)
        agrees = self.shaken[0] <= slope <= self.shaken[1] or self._is_otherwise(short)
        return "" if agrees else self._in_words(slope, self.shaken)

    def proves(self, means: Means, short: Means) -> bool:
        """Whether anything can be stated."""
        if self._pairs(means, self.least) is not None:
            return True
        return self.shaken is not None and self._pairs(short, _SHORT_LEAST * self.least) is not None

    def _is_otherwise(self, means: Means) -> bool:
        expected = None if self.otherwise is None else self.otherwise(means)
        if expected is None:
            return False
        found = means[self.channel]
        known = np.isfinite(expected) & np.isfinite(found)
        moves = bool(np.any(expected[known] != 0.0))
        return moves and self._within(_slope(expected[known], found[known]))

    def _within(self, slope: float) -> bool:
        return self.within[0] <= slope <= self.within[1]

    def _differs_by_no_more(self, expected: Array, found: Array) -> bool:
        """Whether what is missing is as large at every value: friction, which a scale is not.

        Where all values are alike nothing tells the two apart, and no more than friction may be missing.
        Little friction may be missing at some values only: at rest it takes nothing of none.
        """
        around = expected - np.mean(expected)
        alike = bool(np.sqrt(np.mean(around**2)) < 0.5 * self.least)
        if np.max(np.abs(expected - found)) <= (1.0 if alike else _AT_REST) * self.beside:
            return True
        if alike:
            return False
        slope = _slope(around, found - np.mean(found))
        return self._within(slope) and float(abs(np.mean(found) - slope * np.mean(expected))) <= self.beside

    def _pairs(self, means: Means, least: float) -> tuple[Array, Array] | None:
        """What is expected and what is found; None where less than `least`, rms, is expected."""
        if self.channel not in means or any(name not in means for name in self.against):
            return None
        if any(means.largest[name] * _LEAST_SHARE > means.steady(name) for name in self.against):
            return None
        expected, found = self.expected(means), means[self.channel]
        if expected is None:
            return None
        known = np.isfinite(expected) & np.isfinite(found)
        expected, found = expected[known], found[known]
        if len(expected) < _LEAST_MEANS or np.sqrt(np.mean(expected**2)) < least:
            return None
        return expected, found

    def _in_words(self, slope: float, within: tuple[float, float]) -> str:
        neighbours = " and ".join(self.against)
        if abs(slope) < _NOTHING:
            return f"{self.channel} reads zero where {neighbours} demands a signal ({self.law}): it is dead"
        return (
            f"{self.channel} is {slope:.3g} times what {neighbours} demands ({self.law}), "
            f"{within[0]:g} to {within[1]:g} would agree: {self.why}"
        )


def _slope(expected: Array, found: Array) -> float:
    """What is found over what is expected, least squares."""
    return float(expected @ found / (expected @ expected))


def _by_gear(motor: str, *, up: bool) -> Callable[[Means], Array | None]:
    def expected(means: Means) -> Array | None:
        ratio = means.gear_ratio
        return None if ratio is None else means[motor] * (ratio if up else 1 / ratio)

    return expected


def _own(channel: str) -> Callable[[Means], Array | None]:
    return lambda means: means[channel]


def _by_differential(other: str) -> Callable[[Means], Array | None]:
    """The speed of a wheel where one slides, or leads round a bend: both in the mean have the gear's."""

    def expected(means: Means) -> Array | None:
        if means.stated_ratio is None or _MOTOR_SPEED not in means:
            return None
        return 2.0 * means[_MOTOR_SPEED] / means.stated_ratio - means[other]

    return expected


def _rolling(means: Means) -> Array | None:
    radius_m = means.rolling_radius_m
    return None if radius_m is None else means["wheel_speed_rad_s"] * radius_m


_REQUEST, _MOTOR_SPEED = "motor_torque_ref_nm", "motor_speed_rad_s"
_SPEED, _SIDES, _TORQUE, _SLIP = (0.95, 1.05), (0.8, 1.25), (0.8, 1.2), (0.8, 1.2)
_LEAST_SPEED_RAD_S, _LEAST_SPEED_M_S, _LEAST_TORQUE_NM = 0.1, 0.05, 20.0
_TWISTS_RAD_S = 0.4  # a shaft that twists by 0.1 rad within a mean, and comes back in the next

_SENSOR = "a sensor is dead, scaled or mirrored"

#: Sides first: what they show explains what both show.
RELATIONS = (
    Relation(
        "wheel_speed_left_rad_s",
        ("wheel_speed_right_rad_s",),
        "left = right",
        _own("wheel_speed_right_rad_s"),
        (0.9, 1.1),
        _LEAST_SPEED_RAD_S,
        why=_SENSOR,
        shaken=(0.8, 1.25),
        otherwise=_by_differential("wheel_speed_right_rad_s"),
    ),
    *(
        Relation(
            one,
            (other,),
            "left = right, as a differential demands",
            _own(other),
            _SIDES,
            0.5 * _LEAST_TORQUE_NM,
            why=_SENSOR,
            shaken=_SIDES,
        )
        for one, other in itertools.permutations(("shaft_torque_left_nm", "shaft_torque_right_nm"))
    ),
    Relation(
        "wheel_speed_rad_s",
        ("motor_speed_rad_s",),
        "ω_l = ω_m / N",
        _by_gear("motor_speed_rad_s", up=False),
        _SPEED,
        _LEAST_SPEED_RAD_S,
        beside=_TWISTS_RAD_S,
        why=f"{_SENSOR}, or the gear ratio is wrong",
    ),
    Relation(
        "motor_speed_rad_s",
        ("wheel_speed_rad_s",),
        "ω_m = N ω_l",
        _by_gear("wheel_speed_rad_s", up=True),
        _SPEED,
        8 * _LEAST_SPEED_RAD_S,
        beside=8 * _TWISTS_RAD_S,
        why=f"{_SENSOR}, or the gear ratio is wrong",
    ),
    Relation(
        "vehicle_speed_m_s",
        ("wheel_speed_rad_s",),
        "V̂ = r ω_l (1 - slip)",
        _rolling,
        _SLIP,
        _LEAST_SPEED_M_S,
        beside=0.3 * _TWISTS_RAD_S,
        why="it is computed wrongly, the wheels slip more, or the wheel radius is wrong",
    ),
    Relation(
        "motor_torque_nm",
        (_REQUEST,),
        "T_m = T_m*",
        _own(_REQUEST),
        _TORQUE,
        _LEAST_TORQUE_NM / 8,
        why="the RMCU does not give the requested torque, or does not measure it",
        shaken=(0.6, 1.8),
    ),
    Relation(
        "shaft_torque_nm",
        ("motor_torque_nm",),
        "T_s = N T_m, less friction",
        _by_gear("motor_torque_nm", up=True),
        _TORQUE,
        _LEAST_TORQUE_NM,
        why=f"{_SENSOR}, friction is too large, or the gear ratio is wrong",
        shaken=(0.6, 1.8),
        beside=2 * _LEAST_TORQUE_NM,
    ),
)


_CHANNELS = tuple(dict.fromkeys(name for one in RELATIONS for name in one.channels))
_NOTHING_KNOWN = Means({}, {}, None, None)


def contradictions(recording: Recording, segment: Segment) -> dict[str, str]:
    """Channels of a segment that contradict each other, each with how."""
    found: dict[str, str] = {}
    late_s = segment.end_s - _LEAST_S
    for start_s in dict.fromkeys((min(segment.start_s, late_s), late_s)):
        means, short = _both_means(recording, segment, start_s)
        for relation in RELATIONS:
            objection = relation.objection(means, short)
            for name in relation.channels if objection else ():
                found.setdefault(name, objection)
    return found


def proven_channels(recording: Recording, segment: Segment) -> set[str]:
    """Channels of a segment that were held against another."""
    start_s = min(segment.start_s, segment.end_s - _LEAST_S)
    means, short = _both_means(recording, segment, start_s)
    return {name for one in RELATIONS if one.proves(means, short) for name in one.channels}


def _both_means(recording: Recording, segment: Segment, start_s: float) -> tuple[Means, Means]:
    """Means over half a second and over a tenth of one, from `start_s` to the end of a segment."""
    names = [name for name in _CHANNELS if name in recording]
    if not names or recording.samples < 2:
        return _NOTHING_KNOWN, _NOTHING_KNOWN
    first, last = (recording.rows_before(time_s) for time_s in (start_s, segment.end_s))
    rows = recording.rows(first, last, names)
    quarter_s = (last - first) * recording.sample_time_s / _LEAST_MEANS
    mean_s = min(_MEAN_S, quarter_s) if quarter_s >= _SHORTEST_MEAN_S else _MEAN_S
    means, short = (
        _means_of(rows, max(1, math.floor(length_s / recording.sample_time_s)), segment)
        for length_s in (mean_s, _SHORT_MEAN_S)
    )
    return means, short


def _means_of(rows: Mapping[str, Array], length: int, segment: Segment) -> Means:
    """Means over `length` samples; without a known gear ratio, that of the speeds."""
    blocks = {name: values[len(values) % length :] for name, values in rows.items()}
    largest = {
        name: float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))
        for name, values in blocks.items()
    }
    means = {name: _means(values, length) for name, values in blocks.items()}
    ratio = segment.gear_ratio
    radius_m = None if segment.slippery else segment.rolling_radius_m  # wheels that slide do not roll
    return Means(means, largest, ratio or _ratio_of_speeds(means), radius_m, ratio)


def _ratio_of_speeds(means: Mapping[str, Array]) -> float | None:
    """Motor speed over wheel speed; None where they do not turn."""
    if "motor_speed_rad_s" not in means or "wheel_speed_rad_s" not in means:
        return None
    motor, wheel = means["motor_speed_rad_s"], means["wheel_speed_rad_s"]
    known = np.isfinite(motor) & np.isfinite(wheel)
    motor, wheel = motor[known], wheel[known]
    if not len(wheel) or np.sqrt(np.mean(wheel**2)) < _LEAST_SPEED_RAD_S:
        return None
    return abs(float(wheel @ motor / (wheel @ wheel))) or None


def _means(values: Array, length: int) -> Array:
    """Of each block, weighted by a Hann window; NaN where half of its weight or more is missing."""
    blocks = values.reshape(-1, length)
    taper = hann(length)
    weights = np.where(np.isfinite(blocks), taper, 0.0)
    total = np.sum(weights, axis=1)
    sums = np.sum(np.where(weights > 0, blocks, 0.0) * weights, axis=1)
    return np.where(2 * total > np.sum(taper), sums / np.maximum(total, 1e-300), np.nan)
