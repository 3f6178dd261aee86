"""Angles that speeds turn through: what ripples of a recording follow.

A simulated angle drifts off as long as a model is not right to the last digit, and takes the phase of a
ripple with it; the measured one does not.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def turned(samples: Array, dt: float, gear_ratio: float, first_wheel_angle_rad: float = 0.0) -> Array:
    """Wheel and rotor angle in rad at every sample (n x 2), by the trapezoidal rule.

    Args:
        samples: n x 2 or more, motor and wheel speed in rad/s; a column of NaN follows from the other.
    """
    motor, wheel = samples[:, 0], samples[:, 1]
    if not np.isfinite(wheel[0]):
        wheel = motor / gear_ratio
    if not np.isfinite(motor[0]):
        motor = wheel * gear_ratio
    speeds = np.nan_to_num(np.column_stack([wheel, motor]))
    ways = np.cumsum(0.5 * dt * (speeds[1:] + speeds[:-1]), axis=0)
    first = first_wheel_angle_rad * np.array([1.0, gear_ratio])
    return np.asarray(first + np.concatenate([np.zeros((1, 2)), ways]), dtype=float)
