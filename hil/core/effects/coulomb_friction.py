"""Dry friction on the rotor: Coulomb's law with a Stribeck peak, true standstill, and turning over an angle.

While the rotor turns, friction is `torque + stribeck·exp(-|ω/ω_s|^p)` against the motion, with ω_s = 2 rad/s
and p = 2 (Gauss) where nothing else is given; p = 1 is J. Bo's and M. Pavelescu's (Wear 82, 1982). At
standstill it is whatever holds the rotor, up to the break-away torque `torque + stribeck`: nothing creeps
below it (B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083-1138).

With an angle `turn_rad` friction does not turn around at once but as bristles bend:
dF/dθ = (T_c/θ_t)·(1 - sgn(ω)·F/T_c). Over a step without reversal that is an exponential in the angle turned
(P. R. Dahl, A Solid Friction Model, 1968).

With a bristle damping s1 beside it the law is LuGre's: dz/dt = ω - s0·|ω|·z/g(ω), F = s0·z + s1·dz/dt, with
s0 = T_c/θ_t and g the friction above, so that friction follows its level over the angle turned as well
(C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, IEEE Trans. Automatic Control 40, 1995).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Least, Memory, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Direction, Probe, Scene
from hil.core.effects._probe import Values as Named

_TURNED_S = 0.5  # a recording that begins in motion has moved so for as long, and bristles are bent by it
_STIFFEST = 0.5  # largest phase in rad that bristles may swing through in a step
_MOST_STEPS = 8
_SOFT_RAD = 0.3  # friction that turns around over so much is a spring to small motion


# Of the values
_TORQUE, _STRIBECK, _OFFSET, _TURN, _SPEED, _POWER, _BRISTLES = range(7)


def _level(speed: float, values: Values) -> float:
    """Largest friction in N m at a speed of rotor against housing."""
    if values[_STRIBECK] == 0.0:
        return values[_TORQUE]
    ratio = abs(speed / values[_SPEED])
    ratio = ratio * ratio if values[_POWER] == 2.0 else ratio ** values[_POWER]
    return values[_TORQUE] + values[_STRIBECK] * math.exp(-ratio)


def _dry(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    return _level(motion.rotor_speed, values) if values[3] == 0.0 else 0.0


def _loss(motion: Motion, chain: Chain, bent: float, values: Values) -> float:
    if values[3] == 0.0:
        return values[2]
    level = _level(motion.rotor_speed, values)
    if values[_BRISTLES] == 0.0 or values[_TORQUE] == 0.0:
        return values[2] + level * bent
    speed, torque = motion.rotor_speed, values[_TORQUE] * bent
    return values[2] + torque + values[_BRISTLES] * (speed - abs(speed) * torque / level)


def _remember(before: Motion, after: Motion, chain: Chain, bent: float, values: Values, h: float) -> float:
    """Friction as a share of its level, after the angle that the rotor turns in `h` seconds."""
    return _turned_for(h, 0.5 * h * (before.rotor_speed + after.rotor_speed), bent, values)


def _turned_for(h: float, turned: float, bent: float, values: Values) -> float:
    """What becomes of `bent` as the rotor turns by an angle in `h` seconds."""
    if values[_TURN] == 0.0:
        return 0.0
    way, turn = math.copysign(1.0, turned), values[_TURN]
    if values[_BRISTLES] > 0.0 and values[_TORQUE] > 0.0:
        share = _level(turned / h, values) / values[_TORQUE]
        way, turn = way * share, turn * share
    return way + (bent - way) * math.exp(-abs(turned) / turn)


def _turned(speed: float, chain: Chain, values: Values) -> float:
    """Friction as a share of its level at a start in motion: turned around as far as it is fast."""
    return _turned_for(_TURNED_S, speed * _TURNED_S, 0.0, values)


def _steps(chain: Chain, values: Values, dt: float) -> int:
    """Bristles are a spring on the rotor: a step must follow their swinging."""
    if values[3] == 0.0:
        return 1
    swing = dt * math.sqrt((values[0] + values[1]) / (values[3] * chain.motor_inertia))
    return min(max(1, math.ceil(swing / _STIFFEST)), _MOST_STEPS)


def _steady(values: Values) -> bool:
    return (values[1] == 0.0) & (values[3] == 0.0)


def _probes(scene: Scene) -> Iterator[Probe]:
    for turn_rad in (0.0, _SOFT_RAD):
        rest: Named = {"stribeck_torque_nm": 0.0, "offset_nm": 0.0, "turn_rad": turn_rad}
        for share in (0.005, 0.03, 0.1, 0.2):
            unit = share * scene.torque_nm
            yield Probe(
                (Direction({"torque_nm": unit, **rest}, 0.3, 2.0),),
                lambda a, unit=unit, rest=rest: {"torque_nm": float(a[0]) * unit, **rest},  # type: ignore[misc]
            )


def _derived(values: Mapping[str, float]) -> dict[str, float]:
    return {
        "breakaway_forwards_nm": values["torque_nm"] + values["stribeck_torque_nm"] + values["offset_nm"],
        "breakaway_backwards_nm": values["torque_nm"] + values["stribeck_torque_nm"] - values["offset_nm"],
    }


EFFECT = Effect(
    id="coulomb_friction",
    title="Coulomb friction",
    stage=Stage.ROTOR,
    summary="Dry friction on the rotor side, with an optional Stribeck peak, asymmetry and angle of turning.",
    signature="A constant torque against the motion; at standstill small torques cause no motion.",
    shown_by="Speed reversals.",
    needs_reversals=True,
    source="Armstrong-Hélouvry, Dupont, Canudas de Wit, Automatica 30 (1994); P. R. Dahl (1968); "
    "Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Automatic Control 40 (1995)",
    parameters=(
        Parameter("torque_nm", "N m", 0.0, 1e4, "friction torque", typical=0.1),
        Parameter(
            "stribeck_torque_nm",
            "N m",
            0.0,
            1e4,
            "added near standstill",
            optional=True,
            typical=0.1,
            opens=(0.0,),
        ),
        Parameter(
            "offset_nm",
            "N m",
            -1e4,
            1e4,
            "asymmetry: friction that is the same in both directions of turning",
            optional=True,
            typical=0.1,
            opens=(0.0,),
        ),
        Parameter(
            "turn_rad",
            "rad",
            0.0,
            10.0,
            "rotor angle over which friction turns around; 0: at once",
            optional=True,
            within=(1e-4, 10.0),
            opens=(3e-3, 0.03, 0.3),
        ),
        Parameter(
            "stribeck_speed_rad_s",
            "rad/s",
            0.01,
            1e3,
            "rotor speed at which the Stribeck peak has fallen to 1/e",
            optional=True,
            default=2.0,
            within=(0.2, 100.0),
            opens=(1.0, 4.0, 15.0),
            beside=("stribeck_torque_nm",),
        ),
        Parameter(
            "stribeck_power",
            "1",
            0.5,
            4.0,
            "of the speed in the exponent of the peak: 2 Gauss, 1 exponential (Bo, Pavelescu)",
            optional=True,
            default=2.0,
            fitted=False,
            choices=(1.0, 2.0),
            beside=("stribeck_torque_nm",),
        ),
        Parameter(
            "bristle_damping_nms_rad",
            "N m s/rad",
            0.0,
            1e3,
            "of bristles while they bend, beside `turn_rad`; above 0 the law is LuGre's",
            optional=True,
            typical=0.05,
            opens=(0.05, 0.3),
            beside=("turn_rad",),
        ),
    ),
    least=Least(1e-4, "largest torque"),
    law=Law(dry=_dry, loss=_loss, remember=_remember, turned=_turned, steps=_steps, steady=_steady),
    sizes=("torque_nm", "stribeck_torque_nm", "offset_nm"),
    memory=Memory("1", "friction over its level, while it turns around"),
    probes=_probes,
    similar=("running_resistance",),
    derived=_derived,
)
