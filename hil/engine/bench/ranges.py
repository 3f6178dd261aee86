"""Every range that a bench file states, in one form: magnitudes, limits of channels, interlocks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from hil.engine.bench.limit_tables import ChannelLimit, Interlock, Limits, RangeTable

Response = Literal["warn", "pause", "ramp_down", "trip", "hold", "emergency_stop"]

SLOPE_OVER_S = 0.01
#: What a bench may measure in place of both sides.
_WHOLE = {"wheel_speed_rad_s": 1.0, "shaft_torque_nm": 1.0}


@dataclass(frozen=True)
class Range:
    """Where a channel, or its slope, may be, in `unit`, and what is done when it is elsewhere for too long.

    Attributes:
        persistence_s: for how long it may be elsewhere, counted in samples of its stream, at least one;
            unless `persistence_samples` says how many.
        slope_s: time over which the slope is taken, s; None: the value itself is limited.
        message: what a person is to do; of interlocks.
        well_for_s, timeout_s: of interlocks: when a hold ends, well or not.
    """

    channel: str
    below: float
    above: float
    persistence_s: float
    name: str = ""
    unit: str = ""
    persistence_samples: int | None = None
    hysteresis: float = 0.0
    response: Response = "trip"
    slope_s: float | None = None
    message: str = ""
    well_for_s: float = 0.0
    timeout_s: float = math.inf

    def samples(self, period_s: float) -> int:
        """How many samples may be elsewhere, one after the other; the next one reaches the limit."""
        if self.persistence_samples is not None:
            return self.persistence_samples
        return max(1, round(self.persistence_s / period_s))

    @property
    def what(self) -> str:
        """The channel, or its slope, for people."""
        return self.channel if self.slope_s is None else f"slope of {self.channel}"


def limits_of_channels(limits: Limits) -> dict[str, float]:
    """Largest magnitude of each watched channel; a side's share of the shaft torque is half."""
    return {
        "motor_torque_ref_nm": limits.motor_torque_nm,
        "motor_torque_nm": limits.motor_torque_nm,
        "motor_speed_rad_s": limits.motor_speed_rad_s,
        "wheel_speed_left_rad_s": limits.wheel_speed_rad_s,
        "wheel_speed_right_rad_s": limits.wheel_speed_rad_s,
        "shaft_torque_left_nm": 0.5 * limits.shaft_torque_nm,
        "shaft_torque_right_nm": 0.5 * limits.shaft_torque_nm,
        "vehicle_speed_m_s": limits.vehicle_speed_m_s,
    }


def channels_of_magnitudes() -> dict[str, tuple[tuple[str, ...], ...]]:
    """For each magnitude of [limits] that is measured: sets of channels, one of which must be there whole."""
    sides = {
        name: tuple(name.replace(unit, f"_{side}{unit}") for side in ("left", "right"))
        for name, unit in (("wheel_speed_rad_s", "_rad_s"), ("shaft_torque_nm", "_nm"))
    }
    return {
        "motor_torque_nm": (("motor_torque_ref_nm",), ("motor_torque_nm",)),
        "motor_speed_rad_s": (("motor_speed_rad_s",),),
        "vehicle_speed_m_s": (("vehicle_speed_m_s",),),
        **{name: (both, (name,)) for name, both in sides.items()},
    }


def ranges_of(limits: Limits, interlocks: Mapping[str, Interlock] | None = None) -> list[Range]:
    """Every limit of a bench file and its interlocks."""
    whole = {name: share * getattr(limits, name) for name, share in _WHOLE.items()}
    found = [
        Range(channel, -largest, largest, limits.persistence_s, channel)
        for channel, largest in (limits_of_channels(limits) | whole).items()
    ]
    for channel, given in limits.channels.items():
        found.append(_of_limit(channel, channel, given, limits.persistence_s))
    for name, named in limits.watch.items():
        found.append(_of_limit(name, named.channel, named, limits.persistence_s))
    for name, lock in (interlocks or {}).items():
        found.append(_of_interlock(name, lock, limits.persistence_s))
    return found


def _of_limit(name: str, channel: str, given: ChannelLimit, persistence_s: float) -> Range:
    return Range(
        channel,
        *_ends(given),
        persistence_s if given.persistence_s is None else given.persistence_s,
        name,
        given.unit,
        given.persistence_samples,
        given.hysteresis,
        given.response,
        (given.over_s or SLOPE_OVER_S) if given.of == "slope" else None,
    )


def _of_interlock(name: str, lock: Interlock, persistence_s: float) -> Range:
    return Range(
        lock.channel,
        *_ends(lock),
        persistence_s if lock.persistence_s is None else lock.persistence_s,
        name,
        lock.unit,
        lock.persistence_samples,
        lock.hysteresis,
        lock.response,
        message=lock.message,
        well_for_s=lock.well_for_s,
        timeout_s=lock.timeout_s,
    )


def _ends(given: RangeTable) -> tuple[float, float]:
    below = -math.inf if given.below is None else given.below
    return below, math.inf if given.above is None else given.above


def slope_unit(unit: str) -> str:
    """Unit of a channel's slope: rad/s becomes rad/s2."""
    return f"{unit}2" if unit.endswith("/s") else f"{unit}/s"
