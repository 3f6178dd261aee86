"""Rotor, housing, wheel, vehicle, absorber: implicit midpoint rule, a symplectic scheme of order two."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from tests.blind.reference.contact import SERIES, series_contact, shaft_torque
from tests.blind.reference.controller import MEMORY, asked_torque
from tests.blind.reference.friction import bristle_after, friction_torque, running_resistance, settled_bristle
from tests.blind.reference.hysteresis import ELEMENTS, advance
from tests.blind.reference.torque_path import acting, delayed
from tests.blind.reference.tyre import CELLS, angle_behind, patch_after

_ITERATIONS = 2  # contraction is below 0.01 at 50 µs: two leave less than 1e-6


class Chain(NamedTuple):
    """Angles, speeds or accelerations of the bodies."""

    rotor: float
    housing: float
    wheel: float
    vehicle: float
    absorber: float


class Inner(NamedTuple):
    """Bristle, tyre deflection, lateness of the dyno and twist of the shafts in rad; shaft torque in N m."""

    bristle: float
    deflection: float
    behind: float
    wound: float
    shaft: float


@njit(error_model="numpy")
def _ahead(x: Chain, v: Chain, span_s: float) -> Any:
    """`x` after `span_s` at the rates `v`."""
    return Chain(
        x.rotor + span_s * v.rotor,
        x.housing + span_s * v.housing,
        x.wheel + span_s * v.wheel,
        x.vehicle + span_s * v.vehicle,
        x.absorber + span_s * v.absorber,
    )


@njit(error_model="numpy")
def _twist(p: Any, x: Chain) -> float:
    """Twist (or its rate): gear output against wheel; the gear turns with the housing."""
    return x.housing + (x.rotor - x.housing) / p.gear_ratio - x.wheel


@njit(error_model="numpy")
def _through_shafts(p: Any, x: Chain, v: Chain, wound: float, span_s: float, time_s: float) -> Any:
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
    p: Any, x: Chain, v: Chain, drive: float, shaft: float, tyre: float, load: float, time_s: float
) -> Any:
    """Accelerations in rad/s²: `drive` between housing and rotor, `shaft`, `tyre` and `load` on the wheel.

    A load is a dyno's torque in N m; positive, it slows a wheel that turns forward.
    """
    housing = vehicle = absorber = 0.0
    rotor = (drive - shaft / p.gear_ratio) / p.motor_inertia
    if p.has_mount > 0.0:
        stiffness = p.mount_stiffness * (1.0 + p.mount_speed_stiffening * abs(v.wheel))
        bushes = stiffness * x.housing + p.mount_damping * v.housing
        housing = (-drive - shaft * (1.0 - 1.0 / p.gear_ratio) - bushes) / p.housing_inertia
    onto_wheel = shaft - load
    if p.tone_nm > 0.0:
        onto_wheel += p.tone_nm * math.sin(2.0 * math.pi * p.tone_hz * time_s)
    if p.absorber_inertia > 0.0:
        held = p.absorber_stiffness * (x.wheel - x.absorber) + p.absorber_damping * (v.wheel - v.absorber)
        absorber = held / p.absorber_inertia
        onto_wheel -= held
    if p.has_tyre > 0.0:
        wheel = (onto_wheel - tyre) / p.wheel_inertia
        vehicle = (tyre - running_resistance(p, v.vehicle)) / p.vehicle_inertia
    else:
        wheel = (onto_wheel - running_resistance(p, v.wheel)) / p.vehicle_inertia
    return Chain(rotor, housing, wheel, vehicle, absorber)


@njit(error_model="numpy")
def _road(p: Any, vehicle: float, behind: float, span_s: float) -> Any:
    """(speed in rad/s of what the tyre rolls on, angle by which the dyno is behind) after `span_s`."""
    if p.dyno_lag_s <= 0.0:
        return vehicle, behind
    behind = angle_behind(p, behind, vehicle, span_s)
    return behind / p.dyno_lag_s, behind


@njit(error_model="numpy")
def _tyre_after(
    p: Any,
    deflection: float,
    patch: np.ndarray,
    patch_mid: np.ndarray,
    slip: float,
    road: float,
    span_s: float,
) -> Any:
    """(deflection in rad, elastic torque in N m) of the tyre after `span_s` at constant speeds."""
    if p.slip_stiffness > 0.0:
        radius = p.wheel_radius
        return deflection, patch_after(p, patch, patch_mid, radius * slip, radius * road, span_s)
    deflection += span_s * slip
    return deflection, p.tyre_stiffness * deflection


@njit(error_model="numpy", forceinline=True)
def _step(
    p: Any,
    x: Chain,
    v: Chain,
    a: Chain,
    inner: Inner,
    memory: np.ndarray,
    memory_mid: np.ndarray,
    patch: np.ndarray,
    patch_mid: np.ndarray,
    torque: float,
    load: float,
    start_s: float,
    h: float,
) -> Any:
    """Angles, speeds, accelerations and inner state after `h` s at constant torques of motor and dyno.

    Iterates for the middle of the step. `a` are the last accelerations; `inner.shaft` is the torque at the
    end; `memory` of the hysteresis and `patch` of the tyre are changed in place.
    """
    middle = start_s + 0.5 * h
    v_mid = _ahead(v, a, 0.5 * h)  # with the last acceleration, a good first guess
    for _ in range(_ITERATIONS):
        x_mid = _ahead(x, v_mid, 0.5 * h)
        relative = v_mid.rotor - v_mid.housing
        friction = friction_torque(p, bristle_after(p, inner.bristle, relative, 0.5 * h), relative)
        drive = torque - friction - p.viscous_drag * relative
        if p.motor_amplitude > 0.0:
            drive += p.motor_amplitude * math.sin(p.motor_order * x_mid.rotor + p.motor_phase)
        beside = advance(p, memory, memory_mid, _twist(p, v_mid), 0.5 * h)
        through = _through_shafts(p, x_mid, v_mid, inner.wound, 0.5 * h, middle)[1]
        shaft = _with_ripple(p, through + beside, x_mid.wheel)
        road = _road(p, v_mid.vehicle, inner.behind, 0.5 * h)[0]
        slip = v_mid.wheel - road
        held = _tyre_after(p, inner.deflection, patch, patch_mid, slip, road, 0.5 * h)[1]
        tyre = held + p.tyre_damping * slip
        a = _accelerations(p, x_mid, v_mid, drive, shaft, tyre, load, middle)
        v_mid = _ahead(v, a, 0.5 * h)
    bristle = bristle_after(p, inner.bristle, v_mid.rotor - v_mid.housing, h)
    road = _road(p, v_mid.vehicle, inner.behind, 0.5 * h)[0]
    behind = _road(p, v_mid.vehicle, inner.behind, h)[1]
    deflection = _tyre_after(p, inner.deflection, patch, patch_mid, v_mid.wheel - road, road, h)[0]
    if p.slip_stiffness > 0.0:
        patch[:] = patch_mid
    beside = advance(p, memory, memory_mid, _twist(p, v_mid), h)
    if p.hysteresis > 0.0:
        memory[:] = memory_mid
    x = _ahead(x, v_mid, h)
    v = Chain(
        2.0 * v_mid.rotor - v.rotor,
        2.0 * v_mid.housing - v.housing,
        2.0 * v_mid.wheel - v.wheel,
        2.0 * v_mid.vehicle - v.vehicle,
        2.0 * v_mid.absorber - v.absorber,
    )
    # over the whole step the mean rate counts; a spring's torque needs the rate at its end
    play = p.half_gap > 0.0 and p.contact_form == SERIES
    wound, through = _through_shafts(p, x, v_mid if play else v, inner.wound, h, start_s + h)
    return x, v, a, Inner(bristle, deflection, behind, wound, _with_ripple(p, through + beside, x.wheel))


@njit(error_model="numpy")
def simulate_chain(
    p: Any,
    ref: np.ndarray,
    control: Any,
    target: np.ndarray,
    load: np.ndarray,
    noise: np.ndarray,
    wheel_speed: float,
    seat: float,
    substeps: int,
    sample_s: float,
) -> np.ndarray:
    """Samples x (motor speed against housing, wheel speed, shaft torque); `ref` is completed in closed loop.

    `load` is the dyno's torque in N m, straight from sample to sample, `noise` (samples x outputs) what a
    controller reads beside the truth. `wheel_speed` is the initial speed in rad/s; `seat` (-1 to 1) where in
    the free play the flanks start.
    """
    out = np.empty((len(ref), 3))
    h = sample_s / substeps
    memory, memory_mid = np.zeros(ELEMENTS), np.zeros(ELEMENTS)
    patch, patch_mid = np.zeros(CELLS), np.zeros(CELLS)
    x = Chain(seat * p.half_gap * p.gear_ratio, 0.0, 0.0, 0.0, 0.0)
    v = Chain(wheel_speed * p.gear_ratio, 0.0, wheel_speed, wheel_speed, wheel_speed)
    a = Chain(0.0, 0.0, 0.0, 0.0, 0.0)
    inner = Inner(settled_bristle(p, v.rotor), 0.0, p.dyno_lag_s * wheel_speed, 0.0, 0.0)
    smooth = p.lag_s > 0.0 or not math.isinf(p.rate_nm_s)
    lagged = torque = 0.0
    loop = np.zeros(MEMORY)
    loop[1] = wheel_speed
    for k in range(len(ref)):
        time_s = k * sample_s
        out[k, 0] = v.rotor - v.housing
        out[k, 1] = v.wheel
        out[k, 2] = inner.shaft
        if control.proportional > 0.0:
            motor, wheel = v.rotor - v.housing + noise[k, 0], v.wheel + noise[k, 1]
            ref[k] = asked_torque(control, loop, ref[k], target[k], motor, wheel, sample_s)
        for i in range(substeps):
            start = time_s + i * h
            request = delayed(ref[: k + 1], start - p.delay_s, start + h - p.delay_s, sample_s)
            before = torque
            lagged, torque = acting(p, request, lagged, before, start + 0.5 * h, h)
            mean = 0.5 * (before + torque) if smooth else torque
            braking = load[k] + (i + 0.5) / substeps * (load[min(k + 1, len(ref) - 1)] - load[k])
            x, v, a, inner = _step(
                p, x, v, a, inner, memory, memory_mid, patch, patch_mid, mean, braking, start, h
            )
    return out
