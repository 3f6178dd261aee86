"""Shaft torque over twist: free play with a dissipative contact, cubic and asymmetric stiffness."""

from __future__ import annotations

from typing import Any

from numba import njit


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def elastic(p: Any, twist: float, time_s: float) -> float:
    """Spring torque in N m of a twist in rad (free play already taken off)."""
    stiffness = p.shaft_stiffness * (1.0 + p.shaft_drift * time_s)
    if twist < 0.0:
        stiffness *= 1.0 + p.shaft_asymmetry
    return stiffness * twist + p.cubic * twist * twist * twist


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def shaft_torque(p: Any, twist: float, rate: float, time_s: float) -> float:
    """Torque in N m of the shafts behind the free play.

    Damping grows with penetration (Hunt and Crossley, J. Appl. Mech. 42, 1975: dissipation that starts at
    zero force), saturating at the shafts' own damping after `contact_depth`, and flanks never pull.
    """
    gap = p.half_gap
    if gap <= 0.0:
        return elastic(p, twist, time_s) + p.shaft_damping * rate
    if twist > gap:
        depth = twist - gap
        damping = p.shaft_damping * depth / (depth + p.contact_depth)
        return max(0.0, elastic(p, depth, time_s) + damping * rate)
    if twist < -gap:
        depth = -twist - gap
        damping = p.shaft_damping * depth / (depth + p.contact_depth)
        return min(0.0, elastic(p, -depth, time_s) + damping * rate)
    return 0.0
