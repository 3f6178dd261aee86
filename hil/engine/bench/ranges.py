"""Every range that a bench file states, in one form: magnitudes, limits of channels, interlocks.

The tables say what is done when a range is left.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from drivers import Name

Bound = Annotated[float, Field(ge=-1e6, le=1e6)]
Limit = Annotated[float, Field(gt=0, le=1e6, description="a value beyond 1e6 has no effect")]
Persistence = Annotated[float, Field(ge=0, le=10)]


class Table(BaseModel):
    """A table of a bench file: no further keys, no NaN, no number in quotes."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, strict=True)


class RangeTable(Table):
    """Where a channel may be, in its unit; one end may be open."""

    below: Bound | None = None
    above: Bound | None = None
    unit: str = Field("", max_length=20, description="unit of the channel that the device must report")
    hysteresis: float = Field(
        0.0, ge=0, le=1e6, description="distance inside the limit at which a violation ends"
    )
    persistence_s: Persistence | None = Field(None, description="default: that of [limits]")
    persistence_samples: int | None = Field(
        None,
        ge=0,
        le=100_000,
        description="consecutive samples of the channel beyond the limit; 0: the first one counts",
    )

    @model_validator(mode="after")
    def _has_an_end(self) -> Self:
        if self.below is None and self.above is None:
            raise ValueError("sets no limit; give 'below', 'above' or both")
        if self.below is not None and self.above is not None:
            if not self.below < self.above:
                raise ValueError("'below' is not less than 'above'; values less than 'below' trip")
            if not self.below + self.hysteresis < self.above - self.hysteresis:
                raise ValueError("the hysteresis leaves no range between 'below' and 'above'; lower it")
        if self.persistence_s is not None and self.persistence_samples is not None:
            raise ValueError("give persistence_s or persistence_samples, not both")
        return self


class ChannelLimit(RangeTable):
    """A limit of a channel, or of its slope, and what is done when it is reached."""

    of: Literal["value", "slope"] = "value"
    over_s: float | None = Field(
        None, ge=0.001, le=1.0, description="time over which a slope is computed, s; default: 0.01"
    )
    response: Literal["warn", "pause", "ramp_down", "trip"] = "trip"

    @model_validator(mode="after")
    def _over_is_of_a_slope(self) -> Self:
        if self.over_s is not None and self.of != "slope":
            raise ValueError("over_s goes with of = 'slope'")
        return self


class NamedLimit(ChannelLimit):
    """One of several limits of a channel; its unit is stated, and compared with the channel's."""

    channel: str = Field(min_length=1)
    unit: str = Field(min_length=1, max_length=20)


class Interlock(RangeTable):
    """A condition that must hold during a run, and before it is armed."""

    channel: str = Field(min_length=1)
    unit: str = Field(min_length=1, max_length=20)
    message: str = Field(min_length=1, max_length=200, description="instruction for the operator")
    response: Literal["hold", "emergency_stop"] = "hold"
    well_for_s: float = Field(
        1.0, ge=0, le=60, description="a hold ends when the value has been inside the limit for this time, s"
    )
    timeout_s: float = Field(
        60.0, gt=0, le=3600, description="a hold that lasts longer than this, s, ends the run"
    )


class TwistTable(Table):
    """Computation of the shafts' twist: motor speed over gear ratio less wheel speed, integrated."""

    gear_ratio: float = Field(gt=0, le=100, description="motor speed / wheel speed")
    forget_s: float = Field(
        2.0, ge=0.05, le=60, description="time constant with which a constant twist decays, s"
    )


class Limits(Table):
    """Limits of the bench, magnitudes; a plan cannot raise them."""

    motor_torque_nm: Limit
    driving_torque_nm: Limit
    shaft_torque_nm: Limit
    motor_speed_rad_s: Limit
    wheel_speed_rad_s: Limit
    vehicle_speed_m_s: Limit
    persistence_s: float = Field(
        0.005, ge=0, le=10, description="a limit trips when exceeded for longer than this, s"
    )
    channels: dict[str, ChannelLimit] = Field({}, description="limits of additional channels, of any device")
    watch: dict[Name, NamedLimit] = Field(
        {}, description="additional limits by name; a channel can have several"
    )
    twist: TwistTable | None = Field(None, description="provides the channel shaft_twist_rad")


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
