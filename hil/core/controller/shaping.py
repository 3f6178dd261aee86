"""Tables of a controller file that change what Fig. 3 is asked for and with which gains.

Each is off where it is missing.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator

from hil.core.controller.bounds import (
    MOST_SCHEDULE_POINTS,
    Damping,
    DeadTime,
    Factor,
    Gradient,
    HalfGap,
    Inertia,
    Share,
    Slip,
    Speed,
    Stiffness,
    TimeConstant,
    Torque,
    TwistSpeed,
    WheelTorque,
)

_Numbers = Field(min_length=1, max_length=MOST_SCHEDULE_POINTS, strict=False)


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class RequestLimits(_Table):
    """Largest gradients of rF_d*; what is 0 is not limited."""

    rise_nm_s: Gradient = Field(0.0, description="upwards; 0: not limited")
    fall_nm_s: Gradient = Field(0.0, description="downwards; 0: not limited")
    zero_band_nm: WheelTorque = Field(0.0, description="half of a band around zero torque")
    zero_gradient_nm_s: Gradient = Field(0.0, description="both ways within that band; 0: as outside")

    @model_validator(mode="after")
    def _band(self) -> RequestLimits:
        if (self.zero_band_nm > 0.0) != (self.zero_gradient_nm_s > 0.0):
            raise ValueError("zero_band_nm and zero_gradient_nm_s belong together: give both, or neither")
        return self


class SlipWithdrawal(_Table):
    """What the control does when the wheels run ahead by more than a slip: y of (1), σ of `[dfc]`."""

    allowed: Slip = Field(description="|y| beyond which the request falls to what the observer sees")
    recovery_nm_s: Gradient = Field(1000.0, gt=0, description="how fast the request comes back")


class Play(_Table):
    """Reference model of the shafts with their play, and how the play is crossed; wheel side."""

    half_gap_rad: HalfGap = Field(description="g")
    crossing_speed_rad_s: TwistSpeed = Field(2.0, description="v_c, largest speed of the twist on the way")
    crossing_torque_nm: Torque = Field(60.0, description="of the motor, to speed the rotor up and brake it")
    follow_gradient_nm_s: Gradient = Field(5500.0, gt=0, description="R, largest rate of T_s in contact")
    follow_time_constant_s: TimeConstant = Field(0.02, description="τ, with which T_s comes to the request")
    release_gradient_nm_s: Gradient = Field(
        12000.0, gt=0, description="R_u, largest rate of T_s on the flank left"
    )
    landing_margin_rad: HalfGap = Field(0.0, description="before the flank, from which on T_s's rate is R")
    correction: Share = Field(
        1.0, description="share of what ω_m tells of the twist, on the way to the flank"
    )
    gain_factor: Factor = Field(1.0, description="of K_p and K_i while the gap is crossed")
    motor_inertia_kg_m2: Inertia = Field(description="J_m")
    shaft_stiffness_nm_rad: Stiffness = Field(description="k")
    shaft_damping_nms_rad: Damping = Field(0.0, description="c")
    tyre_stiffness_nm_rad: Stiffness | None = Field(
        None, description="none: the wheel turns with the vehicle"
    )
    tyre_damping_nms_rad: Damping = 0.0
    vehicle_inertia_kg_m2: Inertia = Field(description="of the vehicle without the wheels, wheel side")
    dead_time_s: DeadTime = Field(0.0, description="of the torque path")

    @model_validator(mode="after")
    def _margin_within_the_gap(self) -> Play:
        gap_rad = 2.0 * self.half_gap_rad
        if self.landing_margin_rad > gap_rad * (1.0 + 1e-9):
            raise ValueError(
                f"landing_margin_rad = {self.landing_margin_rad:g} is wider than the gap itself, which is "
                f"2 x half_gap_rad = {gap_rad:g}: the play would never be crossed faster than the shafts are "
                "wound"
            )
        return self


class Schedule(_Table):
    """Factors of gains over the vehicle's speed, linear between points and constant beyond them."""

    speed_m_s: Annotated[tuple[Speed, ...], _Numbers]
    wsc_factor: Annotated[tuple[Factor, ...], _Numbers] = Field(description="of K_p and K_i together")
    dfc_factor: Annotated[tuple[Factor, ...], _Numbers] | None = Field(None, description="of K_i(DFC)")

    @model_validator(mode="after")
    def _table(self) -> Schedule:
        points = len(self.speed_m_s)
        if any(later <= earlier for earlier, later in pairwise(self.speed_m_s)):
            raise ValueError("speed_m_s does not rise from point to point")
        for name in ("wsc_factor", "dfc_factor"):
            factors = getattr(self, name)
            if factors is not None and len(factors) != points:
                raise ValueError(f"{name} has {len(factors)} numbers, speed_m_s has {points}")
        return self
