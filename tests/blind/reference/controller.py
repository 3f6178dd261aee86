"""Speed controllers at the sample rate, for recordings that were made in closed loop."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

CONTROL = np.dtype(
    [
        (name, np.float64)
        for name in (
            "proportional", "integral", "filter_s", "largest_nm", "gain", "offset",
            "form", "lead_s", "lead_ratio",
        )
    ]
)  # fmt: skip

#: What is fed back: the filtered wheel speed, or the motor speed as it is read.
ON_WHEEL, ON_MOTOR = 0.0, 1.0
#: Numbers that a controller remembers: integral in rad, filtered wheel speed, input and output of the lead.
MEMORY = 4


def control(
    proportional: float = 0.0,
    integral: float = 0.0,
    filter_s: float = 0.08,
    largest_nm: float = 60.0,
    gain: float = 1.0,
    offset: float = 0.0,
    form: float = ON_WHEEL,
    lead_s: float = 0.0,
    lead_ratio: float = 1.0,
) -> np.void:
    """Gains in N m per rad/s and N m per rad; `gain` and `offset` are those of the sensor that is fed back.

    `lead_s` is T of the phase lead a (T s + 1)/(a T s + 1), `lead_ratio` a; 0 leaves it out.
    """
    row = (proportional, integral, filter_s, largest_nm, gain, offset, form, lead_s, lead_ratio)
    rows: np.ndarray = np.array([row], dtype=CONTROL)
    return rows[0]


@njit(error_model="numpy")
def asked_torque(
    c: Any,
    state: np.ndarray,
    excitation: float,
    target: float,
    motor_speed: float,
    wheel_speed: float,
    sample_s: float,
) -> float:
    """Torque request in N m: test signal plus what the controller adds; the speeds are read with noise.

    `target` is a wheel speed on the wheel, a motor speed on the motor.
    """
    if c.form == ON_MOTOR:
        return motor_speed_torque(c, state, excitation, target, motor_speed, sample_s)
    return pi_torque(c, state, excitation, target, wheel_speed, sample_s)


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


@njit(error_model="numpy")
def motor_speed_torque(
    c: Any, state: np.ndarray, excitation: float, target: float, motor_speed: float, sample_s: float
) -> float:
    """Test signal plus PI and phase lead on the motor speed (Oda et al., (4) to (7) and Fig. 3).

    The lead's gain is one at high frequency; it is discretised by the trapezoidal rule.
    """
    error = target - (c.gain * motor_speed + c.offset)
    asked = c.proportional * error + c.integral * state[0]
    if c.lead_s > 0.0:
        fast, slow = 2.0 * c.lead_s / sample_s, 2.0 * c.lead_ratio * c.lead_s / sample_s
        led = ((slow - 1.0) * state[3] + c.lead_ratio * ((fast + 1.0) * asked - (fast - 1.0) * state[2])) / (
            slow + 1.0
        )
        state[2], state[3] = asked, led
        asked = led
    torque = excitation + asked
    if abs(torque) < c.largest_nm:
        state[0] += error * sample_s
    return min(max(torque, -c.largest_nm), c.largest_nm)
