"""The contact patch of a tyre, and the dynamometer's rotor as the road under it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

#: Cells of the contact patch, at most.
CELLS = 4


@njit(error_model="numpy")
def patch_after(
    p: Any, state: np.ndarray, after: np.ndarray, sliding: float, rolling: float, span_s: float
) -> float:
    """Write the bristles' deflections after `span_s` to `after` (m); return the tyre's torque in N m.

    A brush (Pacejka, Tire and Vehicle Dynamics, 2012, chapter 3): bristles enter the patch undeflected at
    its front, travel through it at `rolling` (m/s) and are pulled at `sliding` (m/s). The patch is cut into
    `patch_cells` cells, upwind, trapezoidal in time. Their number changes how the force builds up, from an
    exponential (1) towards a brush's parabola, but neither the stiffness at rest, C r / sigma, nor the steady
    torque, C times slip.
    """
    cells = int(p.patch_cells)
    length = 2.0 * p.relaxation_length / (cells + 1.0)
    half = 0.5 * abs(rolling) / length * span_s
    entered = entering = total = 0.0
    for number in range(cells):
        i = number if rolling >= 0.0 else cells - 1 - number
        before = state[i]
        after[i] = (before + sliding * span_s + half * (entered + entering - before)) / (1.0 + half)
        entered, entering = before, after[i]
        total += after[i]
    return p.slip_stiffness / p.relaxation_length * total / cells


@njit(error_model="numpy")
def angle_behind(p: Any, behind: float, commanded: float, span_s: float) -> float:
    """Angle in rad by which the dyno's rotor is behind its vehicle model after `span_s`: exact.

    A follow-up drive: it turns in proportion to the angle that it is behind, so that the angle settles at
    the time constant times the speed that is `commanded` (rad/s).
    """
    settled = p.dyno_lag_s * commanded
    return settled + (behind - settled) * math.exp(-span_s / p.dyno_lag_s)
