"""A PI wheel speed controller at the sample rate, for recordings that were made in closed loop."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

CONTROL = np.dtype(
    [(name, np.float64) for name in ("proportional", "integral", "filter_s", "largest_nm", "gain", "offset")]
)


def control(
    proportional: float = 0.0,
    integral: float = 0.0,
    filter_s: float = 0.08,
    largest_nm: float = 60.0,
    gain: float = 1.0,
    offset: float = 0.0,
) -> np.void:
    """Gains in N m per rad/s and N m per rad; `gain` and `offset` are the wheel speed sensor's."""
    row = (proportional, integral, filter_s, largest_nm, gain, offset)
    rows: np.ndarray = np.array([row], dtype=CONTROL)
    return rows[0]


@njit(error_model="numpy")
def pi_torque(
    c: Any, state: np.ndarray, excitation: float, target: float, wheel_speed: float, sample_s: float
) -> float:
    """Torque request in N m: test signal plus PI; the integral stops while the request is clipped.

    state: integral in rad, filtered speed in rad/s.
    """
    reading = c.gain * wheel_speed + c.offset
    state[1] += (1.0 - math.exp(-sample_s / c.filter_s)) * (reading - state[1])
    error = target - state[1]
    torque = excitation + c.proportional * error + c.integral * state[0]
    if abs(torque) < c.largest_nm:
        state[0] += error * sample_s
    return min(max(torque, -c.largest_nm), c.largest_nm)
