"""What the motor can give at a speed, a state of charge and a temperature.

Below its corner speed a motor gives its peak torque; above it the power that inverter and battery pass, so
that torque falls with the speed. Battery and temperature change slowly beside an axle's motion: they are
numbers of a run. Driving power falls linearly to nothing from `low_charge` down to an empty battery,
regenerated power likewise from `high_charge` up to a full one; torque and power from `warm_deg_c` up to
`hot_deg_c`:

    |T| <= d·min(T_p, b·P/|ω|),  d = (ϑ_hot - ϑ)/(ϑ_hot - ϑ_warm) and b from 0 to 1

with ω the rotor's speed against the housing. The request is held over a sample, and the limit with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Values
from hil.core.effects._probe import Probe, Scene, clipped

_STANDS_RAD_S = 1e-3  # below, no power limits a torque
_ANY_NM = 1e6  # a peak torque that is not known limits nothing
_ANY_W = 1e9  # nor does such a power


def _prepare(chain: Chain, values: Values) -> Values:
    """In place of the first three numbers: driving power, peak torque and regenerated power as they are."""
    power, peak, regenerated, charge, low, high, temperature, warm, hot = values
    cool = min(max((hot - temperature) / (hot - warm), 0.0), 1.0)
    gives = min(charge / low, 1.0) if low > 0.0 else 1.0
    takes = min((1.0 - charge) / (1.0 - high), 1.0) if high < 1.0 else 1.0
    back = regenerated if regenerated > 0.0 else power
    return cool * gives * power, cool * peak, cool * takes * back, charge, low, high, temperature, warm, hot


def _limit(torque: float, speed: float, values: Values) -> float:
    """Acting torque in N m at the rotor's speed in rad/s."""
    power = values[0] if torque * speed >= 0.0 else values[2]
    most = values[1]
    if abs(speed) > _STANDS_RAD_S:
        most = min(most, power / abs(speed))
    return min(max(torque, -most), most)


def _probes(scene: Scene) -> Iterator[Probe]:
    """Of the power alone."""
    if scene.power_w > 0.0:
        yield from clipped("power_w", scene.power_w)


def _together(values: Mapping[str, Any], others: Mapping[str, Mapping[str, Any]]) -> tuple[str, str] | None:
    if not values["warm_deg_c"] < values["hot_deg_c"]:
        what = f"warm_deg_c is {values['warm_deg_c']:g}, not below hot_deg_c, {values['hot_deg_c']:g}"
        return what, "torque falls from the one to the other: give a hot_deg_c above warm_deg_c"
    return None


EFFECT = Effect(
    id="motor_limits",
    title="Motor limits",
    stage=Stage.TORQUE_PATH,
    summary="The motor gives no more than peak torque and power allow, at its charge and temperature.",
    signature="Torque falls short of the request at high speed, or of regeneration with a full battery.",
    shown_by="A large torque step at several speeds.",
    parameters=(
        Parameter("power_w", "W", 1e-3, _ANY_W, "largest mechanical power of driving"),
        Parameter(
            "peak_nm",
            "N m",
            1e-6,
            _ANY_NM,
            "largest torque at low speed",
            optional=True,
            default=_ANY_NM,
            opens=(0.97, 0.85, 0.7, 0.55, 0.4, 0.25),
        ),
        Parameter(
            "regenerated_w",
            "W",
            0.0,
            _ANY_W,
            "of regeneration; 0: as of driving",
            optional=True,
            fitted=False,
            choices=(0.0, _ANY_W),
        ),
        Parameter("state_of_charge", "1", 0.0, 1.0, "of the battery", optional=True, default=0.5),
        Parameter("low_charge", "1", 0.0, 1.0, "below which driving power falls", optional=True, default=0.1),
        Parameter(
            "high_charge", "1", 0.0, 1.0, "above which regenerated power falls", optional=True, default=0.9
        ),
        Parameter(
            "temperature_deg_c", "°C", -60.0, 300.0, "of motor or inverter", optional=True, default=60.0
        ),
        Parameter(
            "warm_deg_c",
            "°C",
            -60.0,
            300.0,
            "above which torque and power fall",
            optional=True,
            default=120.0,
        ),
        Parameter("hot_deg_c", "°C", -60.0, 300.0, "at which nothing is left", optional=True, default=160.0),
    ),
    law=Law(prepare=_prepare, limit=_limit),
    off=float("inf"),
    together=_together,
    probes=_probes,
    abrupt=True,
    similar=("torque_saturation",),
)
