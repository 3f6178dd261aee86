"""Replays one torque through many models at once, averaged over blocks of samples: for fits.

Same equations as the step-by-step kernel, except that dry friction truly sticks: an elastic contact of a
fraction of a milliradian that slips at the friction torque, where the kernel has a steep smooth sign.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from numba import prange

from hil.core.compiled import compiled, compiled_parallel, inlined
from sim_backend.plant import _slots as P
from sim_backend.plant._held_linear import STATES, step_matrices

Array = npt.NDArray[np.float64]

CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
GAIN, OFFSET, DELAY = range(3)

_STICK_RATE_RAD_S = 250.0  # of the rotor on its sticking contact: above all modes, below 1 / step
_STICK_DAMPING = 0.7
_STRIBECK_WIDTH_RAD_S = 2.0
_ROLLING_WIDTH_RAD_S = 0.05
_SLIP, _STICK, _WHEEL_ANGLE, _MOTOR_ANGLE = range(4)  # further states, of the nonlinear forces alone


def ideal_sensors(sets: int) -> Array:
    """Gain 1, offset 0, delay 0 s for each of the three channels: sets x 3 x 3."""
    sensors = np.zeros((sets, len(CHANNELS), 3))
    sensors[:, :, GAIN] = 1.0
    return sensors


def simulate_many(
    parameters: Array,
    torque_nm: Array,
    dt: float,
    starts: Array,
    sensors: Array,
    block: int = 1,
    angles: Array | None = None,
) -> Array:
    """Channels of many packed models for one torque request, each the mean of `block` samples.

    Args:
        parameters: sets x slots, from `pack`.
        torque_nm: shape (n,), held for `dt` seconds each; the first value has acted since long before.
        starts: sets x 3: motor speed, wheel speed (rad/s), shaft torque (N m).
        sensors: sets x 3 channels x (gain, offset, delay in s).
        angles: n x 2, wheel and rotor angle in rad that ripples follow (as measured); when left out, the
            simulated ones.

    Returns:
        sets x (n // block) x 3, in the order of `CHANNELS`. A diverged set shows as NaN or huge numbers.
    """
    sets = len(parameters)
    substeps = np.array([_substeps(p) for p in parameters])
    most = int(substeps.max())
    transition = np.zeros((sets, STATES, STATES))
    torque = np.zeros((sets, most, 2, STATES))
    held, rising = np.zeros((sets, 3, STATES)), np.zeros((sets, 3, STATES))
    for index, p in enumerate(parameters):
        used = int(substeps[index])
        matrices = _matrices(p[_LINEAR].tobytes(), dt, used)
        transition[index], held[index], rising[index] = matrices[0], matrices[2], matrices[3]
        torque[index, :used] = matrices[1]
    out = np.empty((sets, len(torque_nm) // block, len(CHANNELS)))
    _run_all(
        np.ascontiguousarray(torque_nm, dtype=float),
        dt,
        np.ascontiguousarray(parameters),
        np.ascontiguousarray(starts, dtype=float),
        np.ascontiguousarray(sensors, dtype=float),
        block,
        substeps,
        (transition, torque, held, rising),
        np.zeros((0, 2)) if angles is None else np.ascontiguousarray(angles, dtype=float),
        out,
    )
    return out


#: Slots on which the step matrices depend.
_LINEAR = [
    P.KIND,
    P.MOTOR_INERTIA,
    P.GEAR_RATIO,
    P.SHAFT_STIFFNESS,
    P.SHAFT_DAMPING,
    P.WHEEL_INERTIA,
    P.TYRE_STIFFNESS,
    P.TYRE_DAMPING,
    P.VEHICLE_INERTIA,
    P.TORQUE_DELAY,
    P.LAG,
    P.DRAG,
    P.HOUSING_INERTIA,
    P.MOUNT_STIFFNESS,
    P.MOUNT_DAMPING,
]
_STATELESS = [P.CUBIC, P.WHEEL_ORDER_AMPLITUDE, P.MOTOR_ORDER_AMPLITUDE, P.ROLLING, P.AERO]
_ABRUPT = [P.HALF_GAP, P.HYSTERESIS_STIFFNESS, P.COULOMB, P.STRIBECK]


@lru_cache(maxsize=512)
def _matrices(linear: bytes, dt: float, substeps: int) -> tuple[Array, Array, Array, Array]:
    p = np.zeros(len(P.NAMES))
    p[_LINEAR] = np.frombuffer(linear)
    return step_matrices(p, dt, substeps)


def _substeps(p: Array) -> int:
    return 2 if np.any(p[_ABRUPT] != 0.0) else 1


@compiled
def _acting(torque, dt, p, out):  # type: ignore[no-untyped-def]
    """Dead band, saturation, slew limit: the torque that acts over each sample, before the delay."""
    band, limit, reach = p[P.DEADBAND], p[P.SATURATION], p[P.RATE_LIMIT] * dt
    slewed = 0.0
    for k in range(torque.shape[0]):
        wanted = torque[k]
        if band > 0.0:
            wanted = math.copysign(max(0.0, abs(wanted) - band), wanted)
        wanted = min(max(wanted, -limit), limit)
        if k == 0:
            slewed = wanted
        gap = wanted - slewed
        if abs(gap) <= reach:  # arrives within the sample: the mean over it
            out[k] = wanted - gap * abs(gap) / (2.0 * reach) if reach < math.inf and gap != 0.0 else wanted
            slewed = wanted
        else:
            moved = slewed + math.copysign(reach, gap)
            out[k] = 0.5 * (slewed + moved)
            slewed = moved


@inlined
def _friction_level(speed, p):  # type: ignore[no-untyped-def]
    ratio = speed / _STRIBECK_WIDTH_RAD_S
    return p[P.COULOMB] + p[P.STRIBECK] * math.exp(-ratio * ratio)


@inlined
def _twist_rate(x, p):  # type: ignore[no-untyped-def]
    return x[7] + (x[0] - x[7]) / p[P.GEAR_RATIO] - x[2]


@inlined
def _forces(x, further, p):  # type: ignore[no-untyped-def]
    """Extra shaft torque, extra rotor loss and load on the vehicle, in N m."""
    shaft = 0.0
    if p[P.KIND] != P.RIGID:
        v = _twist_rate(x, p)
        e = x[1]
        gap = p[P.HALF_GAP]
        if gap > 0.0:
            linear = p[P.SHAFT_STIFFNESS] * e + p[P.SHAFT_DAMPING] * v
            if e > gap:
                e -= gap
                shaft = max(0.0, p[P.SHAFT_STIFFNESS] * e + p[P.SHAFT_DAMPING] * v) - linear
            elif e < -gap:
                e += gap
                shaft = min(0.0, p[P.SHAFT_STIFFNESS] * e + p[P.SHAFT_DAMPING] * v) - linear
            else:
                e = 0.0
                shaft = -linear
        shaft += p[P.CUBIC] * e * e * e + p[P.HYSTERESIS_STIFFNESS] * further[_SLIP]
        if p[P.WHEEL_ORDER_AMPLITUDE] != 0.0:
            shaft += p[P.WHEEL_ORDER_AMPLITUDE] * math.sin(
                p[P.WHEEL_ORDER] * further[_WHEEL_ANGLE] + p[P.WHEEL_ORDER_PHASE]
            )
    loss = p[P.FRICTION_OFFSET]
    speed = x[0] - x[7]
    if p[P.COULOMB] != 0.0 or p[P.STRIBECK] != 0.0:
        level = _friction_level(speed, p)
        share = further[_STICK]
        loss += level * share
        if abs(share) < 1.0:
            inertia = p[P.MOTOR_INERTIA]
            if p[P.KIND] == P.RIGID:
                inertia += p[P.VEHICLE_INERTIA] / (p[P.GEAR_RATIO] * p[P.GEAR_RATIO])
            damping = 2.0 * _STICK_DAMPING * _STICK_RATE_RAD_S * inertia * speed
            loss += min(max(damping, -0.5 * level), 0.5 * level)
    if p[P.MOTOR_ORDER_AMPLITUDE] != 0.0:
        angle = p[P.MOTOR_ORDER] * further[_MOTOR_ANGLE] + p[P.MOTOR_ORDER_PHASE]
        loss -= p[P.MOTOR_ORDER_AMPLITUDE] * math.sin(angle)
    load = 0.0
    if p[P.ROLLING] != 0.0 or p[P.AERO] != 0.0:
        at = x[4]
        load = p[P.ROLLING] * math.tanh(at / _ROLLING_WIDTH_RAD_S) + p[P.AERO] * at * abs(at)
    return shaft, loss, load


@inlined
def _follow(old, x, further, h, p):  # type: ignore[no-untyped-def]
    """Further states after a step in which the main state goes from `old` to `x`."""
    angle = further[_WHEEL_ANGLE] + 0.5 * h * (old[2] + x[2])
    slipped, stuck = further[_SLIP], further[_STICK]
    if p[P.HYSTERESIS_STIFFNESS] != 0.0:
        v = 0.5 * (_twist_rate(old, p) + _twist_rate(x, p))
        slip = p[P.HYSTERESIS_SLIP]
        ratio = further[_SLIP] / slip
        if ratio * v <= 0.0:
            slipped += h * v
        else:
            # r' = (v / slip)·(1 - r²) has the solution tanh: no step is too long for it
            rise = math.tanh(h * v / slip)
            slipped = slip * (ratio + rise) / (1.0 + ratio * rise)
        slipped = min(max(slipped, -slip), slip)
    level = p[P.COULOMB] + p[P.STRIBECK]
    if level > 0.0:
        inertia = p[P.MOTOR_INERTIA]
        if p[P.KIND] == P.RIGID:
            inertia += p[P.VEHICLE_INERTIA] / (p[P.GEAR_RATIO] * p[P.GEAR_RATIO])
        stretch = level / (inertia * _STICK_RATE_RAD_S * _STICK_RATE_RAD_S)
        speed = 0.5 * (old[0] - old[7] + x[0] - x[7])
        stuck = min(max(stuck + h * speed / stretch, -1.0), 1.0)
    return slipped, stuck, angle, p[P.GEAR_RATIO] * (x[1] + angle - x[6])


@inlined
def _at(angles, at, dt, further):  # type: ignore[no-untyped-def]
    """Further states with the given angles at the time `at`, if any are given."""
    if angles.shape[0] == 0:
        return further
    k = min(int(at / dt), angles.shape[0] - 2)
    part = at / dt - k
    return (
        further[0],
        further[1],
        angles[k, 0] + part * (angles[k + 1, 0] - angles[k, 0]),
        angles[k, 1] + part * (angles[k + 1, 1] - angles[k, 1]),
    )


@compiled
def _first_state(p, start, acting, x):  # type: ignore[no-untyped-def]
    x[:] = 0.0
    x[0], x[2], x[5] = start[0], start[1], acting
    if p[P.KIND] == P.RIGID:
        x[2] = start[0] / p[P.GEAR_RATIO]
    else:
        twist = start[2] / p[P.SHAFT_STIFFNESS]
        if p[P.HALF_GAP] > 0.0:
            # a small torque may lie anywhere in the gap: let it come smoothly to one side
            twist += p[P.HALF_GAP] * math.tanh(start[2] / 2.0)
        x[1] = twist
    if p[P.KIND] == P.THREE_INERTIA:
        x[3] = start[2] / p[P.TYRE_STIFFNESS]
    x[4] = x[2]


@compiled
def _observe(x, f, p, acting, row):  # type: ignore[no-untyped-def]
    row[0] = x[0] - x[7]
    row[1] = x[2]
    if p[P.KIND] == P.RIGID:
        n = p[P.GEAR_RATIO]
        inertia = p[P.MOTOR_INERTIA] + p[P.VEHICLE_INERTIA] / (n * n)
        rotor = (acting - f[1] - p[P.DRAG] * x[0] - f[2] / n) / inertia
        row[2] = p[P.VEHICLE_INERTIA] * rotor / n + f[2]
    else:
        row[2] = p[P.SHAFT_STIFFNESS] * x[1] + p[P.SHAFT_DAMPING] * _twist_rate(x, p) + f[0]


@compiled
def _run(torque, dt, p, start, substeps, transition, column, held, rising, angles, fine):  # type: ignore[no-untyped-def]
    """One model over the whole recording into `fine` (n x 3)."""
    n = torque.shape[0]
    acting = np.empty(n)
    _acting(torque, dt, p, acting)
    whole = math.floor(p[P.TORQUE_DELAY] / dt + 1e-9)
    h = dt / substeps
    forced = p[P.FRICTION_OFFSET] != 0.0 or p[P.HALF_GAP] > 0.0 or p[P.HYSTERESIS_STIFFNESS] != 0.0
    forced = forced or p[P.COULOMB] != 0.0 or p[P.STRIBECK] != 0.0 or p[P.CUBIC] != 0.0
    forced = forced or p[P.WHEEL_ORDER_AMPLITUDE] != 0.0 or p[P.MOTOR_ORDER_AMPLITUDE] != 0.0
    forced = forced or p[P.ROLLING] != 0.0 or p[P.AERO] != 0.0
    x, y, z = np.zeros(STATES), np.zeros(STATES), np.zeros(STATES)
    further, f = (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    _first_state(p, start, acting[0], x)
    if forced:
        if x[0] != 0.0:
            further = (0.0, math.tanh(x[0] / 0.2), 0.0, p[P.GEAR_RATIO] * x[1])
        f = _forces(x, further, p)
    for k in range(n):
        new = acting[max(k - whole, 0)]
        old = acting[max(k - whole - 1, 0)]
        _observe(x, f, p, old, fine[k])
        for sub in range(substeps):
            for i in range(8):
                y[i] = column[sub, 0, i] * old + column[sub, 1, i] * new
            for j in range(8):
                xj = x[j]
                for i in range(8):
                    y[i] += transition[j, i] * xj
            if forced:
                for i in range(8):
                    y[i] += held[0, i] * f[0] + held[1, i] * f[1] + held[2, i] * f[2]
                later = k * dt + (sub + 1) * h
                g = _forces(y, _at(angles, later, dt, _follow(x, y, further, h, p)), p)
                for i in range(8):
                    z[i] = y[i] + rising[0, i] * (g[0] - f[0])
                    z[i] += rising[1, i] * (g[1] - f[1]) + rising[2, i] * (g[2] - f[2])
                further = _at(angles, later, dt, _follow(x, z, further, h, p))
                f = _forces(z, further, p)
                for i in range(8):
                    x[i] = z[i]
            else:
                for i in range(8):
                    x[i] = y[i]


@compiled
def _averaged(fine, dt, sensor, block, out):  # type: ignore[no-untyped-def]
    """What the sensors read, averaged over blocks."""
    n = fine.shape[0]
    for c in range(3):
        late = sensor[c, DELAY] / dt
        whole = math.floor(late)
        part = late - whole
        for b in range(out.shape[0]):
            total = 0.0
            for k in range(b * block, (b + 1) * block):
                near = min(max(k - whole, 0), n - 1)
                far = min(max(k - whole - 1, 0), n - 1)
                total += (1.0 - part) * fine[near, c] + part * fine[far, c]
            out[b, c] = sensor[c, GAIN] * total / block + sensor[c, OFFSET]


@compiled_parallel
def _run_all(torque, dt, parameters, starts, sensors, block, substeps, matrices, angles, out):  # type: ignore[no-untyped-def]
    transition, column, held, rising = matrices
    for s in prange(parameters.shape[0]):
        fine = np.empty((torque.shape[0], 3))
        _run(
            torque,
            dt,
            parameters[s],
            starts[s],
            substeps[s],
            transition[s],
            column[s],
            held[s],
            rising[s],
            angles,
            fine,
        )
        _averaged(fine, dt, sensors[s], block, out[s])
