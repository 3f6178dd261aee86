"""Shaft torque over twist: free play in two formulations, cubic and asymmetric stiffness."""

from __future__ import annotations

import math
from typing import Any

from numba import njit


@njit(error_model="numpy")
def elastic(p: Any, twist: float, time_s: float) -> float:
    """Spring torque in N m of a twist in rad (free play already taken off)."""
    stiffness = p.shaft_stiffness * (1.0 + p.shaft_drift * time_s)
    if twist < 0.0:
        stiffness *= 1.0 + p.shaft_asymmetry
    return stiffness * twist + p.cubic * twist * twist * twist


@njit(error_model="numpy")
def _flank_damping(p: Any, depth: float, closing: float) -> float:
    """Torque in N m that closed flanks add when they close at `closing` rad/s; it sets in with the depth."""
    if depth <= 0.0:
        return 0.0
    return p.contact_damping * depth / (depth + p.contact_depth) * closing


#: Forms of the free play.
SERIES, DISSIPATIVE, KELVIN_VOIGT, HUNT_CROSSLEY = 1.0, 2.0, 3.0, 4.0
#: Stiffness of the flanks over that of the shafts: stiff enough to leave the base model's stiffness alone.
_FLANKS = 400.0


@njit(error_model="numpy")
def series_contact(p: Any, wound: float, twist: float, rate: float, span_s: float) -> Any:
    """Free play in series with the shafts: (twist of the shafts after `span_s`, torque in N m).

    Compliant flanks close and open the play; between them the shafts unwind on their own damping, as in
    Nordin, Galic and Gutman (Int. J. Adapt. Control 11, 1997), whose model is the limit of rigid flanks.
    `twist` is the whole twist at the start; the solution for a constant `rate` is exact while no flank
    opens.
    """
    stiffness, damping = p.shaft_stiffness, p.shaft_damping
    before = twist - wound
    side = math.copysign(1.0, before) if abs(before) > p.half_gap else 0.0
    if side == 0.0:
        after = wound * math.exp(-stiffness * span_s / damping)
        end = twist + rate * span_s - after
        if abs(end) <= p.half_gap:
            return after, 0.0
        # closes within the span: the rest of it is in contact
        side = math.copysign(1.0, end)
        free_s = span_s * (side * p.half_gap - before) / (end - before)
        wound *= math.exp(-stiffness * free_s / damping)
        twist += rate * free_s
        span_s -= free_s
    speed = (1.0 + _FLANKS) * stiffness / damping
    part = _FLANKS / (1.0 + _FLANKS)
    start = part * (twist - side * p.half_gap - rate / speed)
    rest = (wound - start) * math.exp(-speed * span_s)
    after = start + part * rate * span_s + rest
    torque = stiffness * after + damping * (part * rate - speed * rest)
    depth = side * (twist + rate * span_s) - p.half_gap
    return after, side * max(0.0, side * torque + _flank_damping(p, depth, side * rate))


@njit(error_model="numpy")
def _bouncing(p: Any, twist: float, rate: float) -> float:
    """Flanks as other authors have them; while they touch, the shafts are damped as without free play.

    Kelvin and Voigt: a damper beside the spring, all of it from the first touch on, so that it pulls before
    flanks part. Hunt and Crossley (1975): `contact_damping` is the factor of depth times rate,
    3/2 (1 - restitution)/speed times stiffness; spring and flanks never pull.
    """
    depth = abs(twist) - p.half_gap
    if depth <= 0.0:
        return 0.0
    side = math.copysign(1.0, twist)
    closing = side * rate
    pushing = p.shaft_stiffness * depth
    if p.contact_form == HUNT_CROSSLEY:
        pushing = max(0.0, pushing + p.contact_damping * depth * closing)
    else:
        pushing += p.contact_damping * closing
    return side * (pushing + p.shaft_damping * closing)


@njit(error_model="numpy")
def shaft_torque(p: Any, twist: float, rate: float, time_s: float) -> float:
    """Torque in N m of the shafts, and of a free play whose flanks dissipate.

    Damping grows with penetration (Hunt and Crossley, J. Appl. Mech. 42, 1975: dissipation that starts at
    zero force), saturating at the shafts' own damping after `contact_depth`, and flanks never pull.
    """
    gap = p.half_gap
    if gap <= 0.0:
        return elastic(p, twist, time_s) + (p.shaft_damping + p.squeeze_damping * abs(rate)) * rate
    if p.contact_form >= KELVIN_VOIGT:
        return _bouncing(p, twist, rate)
    if twist > gap:
        depth = twist - gap
        damping = p.shaft_damping * depth / (depth + p.contact_depth)
        return max(0.0, elastic(p, depth, time_s) + damping * rate + _flank_damping(p, depth, rate))
    if twist < -gap:
        depth = -twist - gap
        damping = p.shaft_damping * depth / (depth + p.contact_depth)
        return min(0.0, elastic(p, -depth, time_s) + damping * rate - _flank_damping(p, depth, -rate))
    return 0.0
