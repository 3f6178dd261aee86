"""The tyre passes no more torque than its friction allows; beyond, it slides and holds less.

The averaged LuGre model (C. Canudas-de-Wit, P. Tsiotras, E. Velenis, M. Basset, G. Gissinger: Dynamic
friction models for road/tire longitudinal interaction, Vehicle System Dynamics 39, 2003), for the twist θ of
a tyre with stiffness k and damping D; with v = ω_l - ω_v

    θ' = v - |v|·k·θ / g(v),  T = k·θ + D·θ',  g(v) = µ·(T_s + (T_p - T_s)·exp(-(v/v_s)²))

T never passes g for long: T_p is the largest torque before the tyre slides, T_s what it holds when it slides
fast, both wheels together. µ is `road_friction`, and `patch_friction` times that where the vehicle is on a
patch; patches and the stretches between them have the same length. A plan changes `road_friction` in the
middle of a run, at the dynos' panel. The damping acts on the twist's own rate: it does not hold a tyre
that slides. Where `tyre_slip` is there too, its relaxation comes on top.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Memory, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values


def _held(speed: float, travel: float, chain: Chain, values: Values) -> float:
    """Largest torque in N m at a sliding speed in rad/s, after a travel of the vehicle in rad."""
    peak, sliding, fades_at, friction, length, road = values
    ratio = speed / fades_at
    torque = sliding + (peak - sliding) * math.exp(-ratio * ratio)
    if road != 1.0:
        torque *= road
    if friction != 1.0 and math.floor(travel * chain.wheel_radius_m / length) % 2.0 == 1.0:
        torque *= friction
    return torque


def _sliding(motion: Motion, chain: Chain, travel: float, values: Values) -> float:
    """Rate in rad/s at which contact slides away under the tyre, against its twist."""
    speed = motion.wheel_speed - motion.vehicle_speed
    held = _held(speed, travel, chain, values)
    return -abs(speed) * chain.tyre_stiffness * motion.tyre_twist / held


def _tyre(motion: Motion, chain: Chain, travel: float, values: Values) -> float:
    return chain.tyre_damping * _sliding(motion, chain, travel, values)


def _remember(before: Motion, after: Motion, chain: Chain, travel: float, values: Values, h: float) -> float:
    """Travel of the vehicle, rad of a wheel that does not slip."""
    return travel + 0.5 * h * (before.vehicle_speed + after.vehicle_speed)


def _together(values: Mapping[str, Any], others: Mapping[str, Mapping[str, Any]]) -> tuple[str, str] | None:
    if 0.0 < values["peak_nm"] < values["sliding_nm"]:
        what = f"sliding_nm is {values['sliding_nm']:g} N m, above peak_nm, {values['peak_nm']:g}"
        return what, "a tyre that slides holds no more than its peak: give a sliding_nm of at most peak_nm"
    return None


EFFECT = Effect(
    id="tyre_friction",
    title="Tyre friction",
    stage=Stage.TYRE,
    summary=(
        "The tyre passes no more torque than the road's friction allows; beyond, it slides and holds less. "
        "The road may have patches of lower friction."
    ),
    signature="Shaft torque stays below a bound, and the wheel runs ahead of the vehicle.",
    shown_by="A torque step from standstill that is larger than the bound.",
    source="C. Canudas-de-Wit et al., Vehicle System Dynamics 39, 2003: averaged LuGre tyre model",
    parameters=(
        Parameter(
            "peak_nm", "N m", 0.0, 1e6, "largest torque before the tyre slides, both wheels; 0: no bound"
        ),
        Parameter("sliding_nm", "N m", 1e-3, 1e6, "torque that it holds when it slides fast, both wheels"),
        Parameter(
            "fades_at_rad_s",
            "rad/s",
            1e-3,
            1e3,
            "sliding speed over which friction fades from peak to sliding",
            optional=True,
            default=3.0,
        ),
        Parameter(
            "patch_friction",
            "1",
            1e-3,
            10.0,
            "friction on patches of the road, a share of that beside them",
            optional=True,
            default=1.0,
        ),
        Parameter(
            "patch_length_m",
            "m",
            1e-2,
            1e5,
            "length of patches, and of what lies between",
            optional=True,
            default=1.0,
        ),
        Parameter(
            "road_friction",
            "1",
            1e-3,
            10.0,
            "friction of the whole road, a share of peak_nm and sliding_nm",
            optional=True,
            default=1.0,
        ),
    ),
    needs=("three_inertia",),
    law=Law(tyre=_tyre, tyre_rate=_sliding, remember=_remember),
    memory=Memory("rad", "travel of the vehicle, as an angle of a wheel that does not slip"),
    similar=("tyre_slip",),
    together=_together,
)
