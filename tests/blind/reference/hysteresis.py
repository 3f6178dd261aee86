"""Hysteretic path beside the shafts: Bouc-Wen (Wen 1976) or parallel Masing elements (Iwan 1966)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

BOUC_WEN = 1.0
MASING = 2.0
#: Elements of equal stiffness; their slips lie evenly in 0.5 to 1.5 times the mean slip.
ELEMENTS = 10


@njit(error_model="numpy")
def _bouc_wen_slope(p: Any, fraction: float, rate: float) -> float:
    """d(fraction)/dt for a twist rate in rad/s; beta = gamma = 0.5, A = 1."""
    full = abs(fraction) ** p.hysteresis_sharpness if fraction * rate > 0.0 else 0.0
    return rate / p.hysteresis_slip * (1.0 - full)


@njit(error_model="numpy")
def advance(p: Any, state: np.ndarray, after: np.ndarray, rate: float, span_s: float) -> float:
    """Write the state after `span_s` of twist rate `rate` to `after`; return the torque in N m.

    Bouc-Wen keeps its fraction of the slip torque in state[0]; each Masing element keeps its deflection.
    """
    if p.hysteresis == BOUC_WEN:
        half = state[0] + 0.5 * span_s * _bouc_wen_slope(p, state[0], rate)
        after[0] = state[0] + span_s * _bouc_wen_slope(p, half, rate)
        after[0] = min(max(after[0], -1.0), 1.0)
        return p.hysteresis_stiffness * p.hysteresis_slip * after[0]
    if p.hysteresis == MASING:
        total = 0.0
        for i in range(ELEMENTS):
            slip = p.hysteresis_slip * (0.5 + (i + 0.5) / ELEMENTS)
            after[i] = min(max(state[i] + rate * span_s, -slip), slip)
            total += after[i]
        return p.hysteresis_stiffness * total / ELEMENTS
    return 0.0
