"""One rotating mass: the rigid driveline, with the same torque path, friction and load."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from tests.blind.reference.controller import MEMORY, asked_torque
from tests.blind.reference.friction import bristle_after, friction_torque, running_resistance, settled_bristle
from tests.blind.reference.torque_path import acting, delayed

_ITERATIONS = 3


@njit(error_model="numpy")
def _acceleration(p: Any, drive: float, held: float, bristle: float, angle: float, speed: float) -> float:
    """Rotor acceleration in rad/s²; `held` is the dyno's torque in N m on the wheel's side."""
    ripple = p.motor_amplitude * math.sin(p.motor_order * angle + p.motor_phase)
    loss = friction_torque(p, bristle, speed) + p.viscous_drag * speed
    load = (running_resistance(p, speed / p.gear_ratio) + held) / p.gear_ratio
    inertia = p.motor_inertia + p.vehicle_inertia / p.gear_ratio**2
    return (drive + ripple - loss - load) / inertia


@njit(error_model="numpy")
def simulate_rigid(
    p: Any,
    ref: np.ndarray,
    control: Any,
    target: np.ndarray,
    load: np.ndarray,
    noise: np.ndarray,
    wheel_speed: float,
    substeps: int,
    sample_s: float,
) -> np.ndarray:
    """Samples x (motor speed, wheel speed, torque that the load needs); see simulate_chain."""
    n = len(ref)
    out = np.empty((n, 3))
    h = sample_s / substeps
    speed, angle = wheel_speed * p.gear_ratio, 0.0
    bristle, lagged, torque = settled_bristle(p, speed), 0.0, 0.0
    loop = np.zeros(MEMORY)
    loop[1] = wheel_speed
    for k in range(n):
        time_s = k * sample_s
        if control.proportional > 0.0:
            motor, wheel = speed + noise[k, 0], speed / p.gear_ratio + noise[k, 1]
            ref[k] = asked_torque(control, loop, ref[k], target[k], motor, wheel, sample_s)
        out[k, 0] = speed
        out[k, 1] = speed / p.gear_ratio
        for i in range(substeps):
            start = time_s + i * h
            request = delayed(ref[: k + 1], start - p.delay_s, start + h - p.delay_s, sample_s)
            lagged, torque = acting(p, request, lagged, torque, start + 0.5 * h, h)
            if i == 0:
                pull = _acceleration(p, torque, load[k], bristle, angle, speed) / p.gear_ratio
                out[k, 2] = p.vehicle_inertia * pull + running_resistance(p, speed / p.gear_ratio) + load[k]
            braking = load[k] + (i + 0.5) / substeps * (load[min(k + 1, n - 1)] - load[k])
            middle = speed
            for _ in range(_ITERATIONS):
                half = bristle_after(p, bristle, middle, 0.5 * h)
                middle = speed + 0.5 * h * _acceleration(
                    p, torque, braking, half, angle + 0.5 * h * middle, middle
                )
            bristle = bristle_after(p, bristle, middle, h)
            angle += h * middle
            speed = 2.0 * middle - speed
    return out
