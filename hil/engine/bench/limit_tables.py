"""The bench file's tables of limits and interlocks: ranges of channels, and what is done when one is left."""

from __future__ import annotations

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
