"""Dry friction with a bristle (LuGre: Canudas de Wit et al., IEEE TAC 40, 1995); running resistance."""

from __future__ import annotations

import math
from typing import Any

from numba import njit


@njit(error_model="numpy")
def sliding_torque(p: Any, speed: float) -> float:
    """Stribeck curve in N m at a steady sliding speed in rad/s, without sign."""
    if p.stribeck == 0.0:
        return p.coulomb
    return p.coulomb + p.stribeck * math.exp(-(abs(speed / p.stribeck_speed) ** p.stribeck_power))


@njit(error_model="numpy")
def bristle_after(p: Any, bristle: float, speed: float, span_s: float) -> float:
    """Bristle deflection in rad after `span_s` at constant speed: the exact solution.

    dz/dt = v - sigma0 |v| z / g(v) is linear in z, and stiff at speed: an explicit step would not do.
    """
    if speed == 0.0 or p.coulomb <= 0.0:
        return bristle
    steady = math.copysign(sliding_torque(p, speed) / p.bristle_stiffness, speed)
    if p.bristle_exponent != 1.0:
        return steady * (1.0 - _missing_after(p, 1.0 - bristle / steady, abs(speed) * span_s / abs(steady)))
    return steady + (bristle - steady) * math.exp(-abs(speed) * span_s / abs(steady))


@njit(error_model="numpy")
def _missing_after(p: Any, missing: float, turned: float) -> float:
    """Share of the steady torque that is missing, after an angle `turned` in units of the settling angle.

    Dahl (1968) with an exponent n: d(share)/d(angle) = -share**n; below 1 it is met at a finite angle.
    """
    power = 1.0 - p.bristle_exponent
    missing = max(missing, 0.0)
    if missing == 0.0:
        return 0.0
    left = missing**power - power * turned
    return left ** (1.0 / power) if left > 0.0 else 0.0


@njit(error_model="numpy")
def settled_bristle(p: Any, speed: float) -> float:
    """Bristle deflection in rad after a long time at `speed`: how a recording that starts at speed begins."""
    if speed == 0.0 or p.coulomb <= 0.0:
        return 0.0
    return math.copysign(sliding_torque(p, speed) / p.bristle_stiffness, speed)


@njit(error_model="numpy")
def friction_torque(p: Any, bristle: float, speed: float) -> float:
    """Torque in N m against the rotor: bristles, their damping, and what is equal in both directions."""
    if p.coulomb <= 0.0:
        return p.friction_offset
    if p.bristle_exponent != 1.0:
        return p.bristle_stiffness * bristle + p.friction_offset
    rate = speed - p.bristle_stiffness * abs(speed) * bristle / sliding_torque(p, speed)
    return p.bristle_stiffness * bristle + p.bristle_damping * rate + p.friction_offset


@njit(error_model="numpy")
def running_resistance(p: Any, speed: float) -> float:
    """Torque in N m against the vehicle: rolling with a smooth sign, air by the square of the speed."""
    if p.rolling == 0.0:
        return p.aero * speed * abs(speed)
    return p.rolling * math.tanh(speed / p.rolling_speed) + p.aero * speed * abs(speed)
