"""Rotor, housing, wheel, vehicle, absorber: implicit midpoint rule, a symplectic scheme of order two."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from tests.blind.reference.contact import SERIES, series_contact, shaft_torque
from tests.blind.reference.controller import pi_torque
from tests.blind.reference.friction import bristle_after, friction_torque, running_resistance, settled_bristle
from tests.blind.reference.hysteresis import ELEMENTS, advance
from tests.blind.reference.torque_path import acting, delayed

ROTOR, HOUSING, WHEEL, VEHICLE, ABSORBER = range(5)
BRISTLE, DEFLECTION, WOUND, SHAFT = range(4)
_ITERATIONS = 2  # contraction is below 0.01 at 50 µs: two leave less than 1e-6


@njit(error_model="numpy")
def _twist(p: Any, x: np.ndarray) -> float:
    """Twist (or its rate): gear output against wheel; the gear turns with the housing."""
    return x[HOUSING] + (x[ROTOR] - x[HOUSING]) / p.gear_ratio - x[WHEEL]


@njit(error_model="numpy")
def _through_shafts(p: Any, x: np.ndarray, v: np.ndarray, wound: float, span_s: float, time_s: float) -> Any:
    """(twist of the shafts, torque in N m) at `x`, `v`, a time `span_s` after they had the twist `wound`."""
    twist, rate = _twist(p, x), _twist(p, v)
    if p.half_gap > 0.0 and p.contact_form == SERIES:
        return series_contact(p, wound, twist - rate * span_s, rate, span_s)
    return twist, shaft_torque(p, twist, rate, time_s)


@njit(error_model="numpy")
def _with_ripple(p: Any, torque: float, wheel_angle: float) -> float:
    """Shaft torque in N m with the joints' and tyres' ripple."""
    if p.wheel_amplitude > 0.0:
        torque += p.wheel_amplitude * math.sin(p.wheel_order * wheel_angle + p.wheel_phase)
    return torque


@njit(error_model="numpy")
def _accelerations(
    p: Any,
    x: np.ndarray,
    v: np.ndarray,
    drive: float,
    shaft: float,
    tyre: float,
    time_s: float,
    a: np.ndarray,
) -> None:
    """Write accelerations in rad/s²: `drive` between housing and rotor, `shaft` and `tyre` on the wheel."""
    a[ROTOR] = (drive - shaft / p.gear_ratio) / p.motor_inertia
    if p.has_mount > 0.0:
        stiffness = p.mount_stiffness * (1.0 + p.mount_speed_stiffening * abs(v[WHEEL]))
        bushes = stiffness * x[HOUSING] + p.mount_damping * v[HOUSING]
        a[HOUSING] = (-drive - shaft * (1.0 - 1.0 / p.gear_ratio) - bushes) / p.housing_inertia
    wheel = shaft
    if p.tone_nm > 0.0:
        wheel += p.tone_nm * math.sin(2.0 * math.pi * p.tone_hz * time_s)
    if p.absorber_inertia > 0.0:
        held = p.absorber_stiffness * (x[WHEEL] - x[ABSORBER]) + p.absorber_damping * (v[WHEEL] - v[ABSORBER])
        a[ABSORBER] = held / p.absorber_inertia
        wheel -= held
    if p.has_tyre > 0.0:
        a[WHEEL] = (wheel - tyre) / p.wheel_inertia
        a[VEHICLE] = (tyre - running_resistance(p, v[VEHICLE])) / p.vehicle_inertia
    else:
        a[WHEEL] = (wheel - running_resistance(p, v[WHEEL])) / p.vehicle_inertia


@njit(error_model="numpy")
def _tyre_after(p: Any, deflection: float, slip_speed: float, span_s: float) -> float:
    """Tyre deflection in rad after `span_s`; with a finite slip angle it slides as in Dahl's model (1968)."""
    if math.isinf(p.slip_angle):
        return deflection + span_s * slip_speed
    steady = math.copysign(p.slip_angle, slip_speed)
    return steady + (deflection - steady) * math.exp(-abs(slip_speed) * span_s / p.slip_angle)


@njit(error_model="numpy")
def _step(
    p: Any,
    x: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
    inner: np.ndarray,
    memory: np.ndarray,
    torque: float,
    start_s: float,
    h: float,
    work: Any,
) -> None:
    """Advance the chain by `h` s at a constant motor torque: iterate for the middle of the step.

    x, v, a: angles, speeds, last accelerations; inner: bristle, tyre deflection, twist of the shafts,
    shaft torque at the end; memory: of the hysteresis; work: arrays for the middle of the step.
    """
    x_mid, v_mid, memory_mid = work
    middle = start_s + 0.5 * h
    for j in range(5):
        v_mid[j] = v[j] + 0.5 * h * a[j]  # with the last acceleration, a good first guess
    for _ in range(_ITERATIONS):
        for j in range(5):
            x_mid[j] = x[j] + 0.5 * h * v_mid[j]
        relative = v_mid[ROTOR] - v_mid[HOUSING]
        friction = friction_torque(p, bristle_after(p, inner[BRISTLE], relative, 0.5 * h), relative)
        drive = torque - friction - p.viscous_drag * relative
        if p.motor_amplitude > 0.0:
            drive += p.motor_amplitude * math.sin(p.motor_order * x_mid[ROTOR] + p.motor_phase)
        beside = advance(p, memory, memory_mid, _twist(p, v_mid), 0.5 * h)
        through = _through_shafts(p, x_mid, v_mid, inner[WOUND], 0.5 * h, middle)[1]
        shaft = _with_ripple(p, through + beside, x_mid[WHEEL])
        slip = v_mid[WHEEL] - v_mid[VEHICLE]
        tyre = p.tyre_stiffness * _tyre_after(p, inner[DEFLECTION], slip, 0.5 * h) + p.tyre_damping * slip
        _accelerations(p, x_mid, v_mid, drive, shaft, tyre, middle, a)
        for j in range(5):
            v_mid[j] = v[j] + 0.5 * h * a[j]
    inner[BRISTLE] = bristle_after(p, inner[BRISTLE], v_mid[ROTOR] - v_mid[HOUSING], h)
    inner[DEFLECTION] = _tyre_after(p, inner[DEFLECTION], v_mid[WHEEL] - v_mid[VEHICLE], h)
    beside = advance(p, memory, memory_mid, _twist(p, v_mid), h)
    memory[:] = memory_mid
    for j in range(5):
        x[j] += h * v_mid[j]
        v[j] = 2.0 * v_mid[j] - v[j]
    # over the whole step the mean rate counts; a spring's torque needs the rate at its end
    play = p.half_gap > 0.0 and p.contact_form == SERIES
    inner[WOUND], through = _through_shafts(p, x, v_mid if play else v, inner[WOUND], h, start_s + h)
    inner[SHAFT] = _with_ripple(p, through + beside, x[WHEEL])


@njit(error_model="numpy")
def simulate_chain(
    p: Any,
    ref: np.ndarray,
    control: Any,
    target: np.ndarray,
    wheel_noise: np.ndarray,
    wheel_speed: float,
    seat: float,
    substeps: int,
    sample_s: float,
) -> np.ndarray:
    """Samples x (motor speed against housing, wheel speed, shaft torque); `ref` is completed in closed loop.

    `wheel_speed` is the initial speed in rad/s; `seat` (-1 to 1) where in the free play the flanks start.
    """
    out = np.empty((len(ref), 3))
    h = sample_s / substeps
    x, v, a, inner, memory = np.zeros(5), np.zeros(5), np.zeros(5), np.zeros(4), np.zeros(ELEMENTS)
    work = (np.zeros(5), np.zeros(5), np.zeros(ELEMENTS))
    v[ROTOR] = wheel_speed * p.gear_ratio
    v[WHEEL] = v[VEHICLE] = v[ABSORBER] = wheel_speed
    x[ROTOR] = seat * p.half_gap * p.gear_ratio
    inner[BRISTLE] = settled_bristle(p, v[ROTOR])
    lagged = torque = 0.0
    loop = np.zeros(2)
    loop[1] = wheel_speed
    for k in range(len(ref)):
        time_s = k * sample_s
        out[k, 0] = v[ROTOR] - v[HOUSING]
        out[k, 1] = v[WHEEL]
        out[k, 2] = inner[SHAFT]
        if control.proportional > 0.0:
            ref[k] = pi_torque(control, loop, ref[k], target[k], v[WHEEL] + wheel_noise[k], sample_s)
        for i in range(substeps):
            start = time_s + i * h
            request = delayed(ref[: k + 1], start - p.delay_s, start + h - p.delay_s, sample_s)
            before = torque
            lagged, torque = acting(p, request, lagged, before, start + 0.5 * h, h)
            smooth = p.lag_s > 0.0 or not math.isinf(p.rate_nm_s)
            _step(p, x, v, a, inner, memory, 0.5 * (before + torque) if smooth else torque, start, h, work)
    return out
