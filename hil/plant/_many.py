"""Replays one torque through many models at once, averaged over blocks of samples: for fits.

Same equations as the step-by-step kernel; the linear part moves exactly, the nonlinear forces are inputs.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from numba import prange

from hil.core.compiled import compiled, compiled_parallel, inlined
from hil.plant import _held_forces as F
from hil.plant import _slots as P
from hil.plant._friction import friction_level, has_friction, mean_friction
from hil.plant._held_linear import STATES, step_matrices
from hil.plant._kernel import as_tuple

Array = npt.NDArray[np.float64]

CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
GAIN, OFFSET, DELAY = range(3)

_SEATED_NM = 2.0  # a first shaft torque that surely is in contact


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
    torque = np.zeros((sets, 2 * most, STATES))
    held, rising = np.zeros((sets, 3, STATES)), np.zeros((sets, 3, STATES))
    for index, p in enumerate(parameters):
        used = int(substeps[index])
        matrices = _matrices(p[_LINEAR].tobytes(), dt, used)
        transition[index], held[index], rising[index] = matrices[0], matrices[2], matrices[3]
        torque[index, : 2 * used] = matrices[1].reshape(-1, STATES)
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
_ABRUPT = [P.HALF_GAP, P.HYSTERESIS_STIFFNESS]


@lru_cache(maxsize=512)
def _matrices(linear: bytes, dt: float, substeps: int) -> tuple[Array, Array, Array, Array]:
    p = np.zeros(len(P.NAMES))
    p[_LINEAR] = np.frombuffer(linear)
    return step_matrices(p, dt, substeps)


def _substeps(p: Array) -> int:
    return 2 if np.any(p[_ABRUPT] != 0.0) else 1


@compiled
def _acting(torque, dt, p, out, ends):  # type: ignore[no-untyped-def]
    """Dead band, saturation, slew limit: the torque over each sample and at its end, before the delay."""
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
        ends[k] = slewed


@compiled
def _shown(acting, ends, dt, whole, p, out):  # type: ignore[no-untyped-def]
    """The delayed torque at each sample's instant: what a rigid axle's shaft torque shows of it."""
    reach = (1.0 + whole - p[P.TORQUE_DELAY] / dt) * p[P.RATE_LIMIT] * dt
    for k in range(acting.shape[0]):
        now = max(k - whole - 1, 0)
        out[k] = acting[now]
        if p[P.RATE_LIMIT] < math.inf:
            before = ends[max(now - 1, 0)]
            gap = ends[now] - before
            out[k] = before + math.copysign(min(abs(gap), reach), gap)


@inlined
def _first_seat(p, start):  # type: ignore[no-untyped-def]
    """A small torque may lie anywhere in the gap: let it come smoothly to one side."""
    return p[P.HALF_GAP] * min(max(start[2] / _SEATED_NM, -1.0), 1.0)


@compiled
def _first_state(p, start, acting):  # type: ignore[no-untyped-def]
    if p[P.KIND] == P.RIGID:
        wheel = start[0] / p[P.GEAR_RATIO]
        return (start[0], 0.0, wheel, 0.0, wheel, acting, 0.0, 0.0)
    twist = start[2] / p[P.SHAFT_STIFFNESS]
    twist += _first_seat(p, start)
    tyre = start[2] / p[P.TYRE_STIFFNESS] if p[P.KIND] == P.THREE_INERTIA else 0.0
    return (start[0], twist, start[1], tyre, start[1], acting, 0.0, 0.0)


@inlined
def _plus(y, matrix, row, s):  # type: ignore[no-untyped-def]
    """State y + s·(row of the matrix). States are tuples: the compiler keeps them in registers."""
    return (
        y[0] + s * matrix[row, 0],
        y[1] + s * matrix[row, 1],
        y[2] + s * matrix[row, 2],
        y[3] + s * matrix[row, 3],
        y[4] + s * matrix[row, 4],
        y[5] + s * matrix[row, 5],
        y[6] + s * matrix[row, 6],
        y[7] + s * matrix[row, 7],
    )


@inlined
def _moved(x, sub, old, new, column, transition):  # type: ignore[no-untyped-def]
    """State after substep `sub` from `x` without any nonlinear force."""
    y = _plus((0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), column, 2 * sub, old)
    y = _plus(y, column, 2 * sub + 1, new)
    y = _plus(y, transition, 0, x[0])
    y = _plus(y, transition, 1, x[1])
    y = _plus(y, transition, 2, x[2])
    y = _plus(y, transition, 3, x[3])
    y = _plus(y, transition, 4, x[4])
    y = _plus(y, transition, 5, x[5])
    y = _plus(y, transition, 6, x[6])
    return _plus(y, transition, 7, x[7])


@compiled
def _run_linear(drive, whole, p, x, substeps, column, transition, fine):  # type: ignore[no-untyped-def]
    acting, shown = drive
    for k in range(acting.shape[0]):
        new = acting[max(k - whole, 0)]
        old = acting[max(k - whole - 1, 0)]
        fine[k, 0] = x[0] - x[7]
        fine[k, 1] = x[2]
        fine[k, 2] = F.shaft_torque(x, (0.0, 0.0, 0.0), p, shown[k])
        for sub in range(substeps):
            x = _moved(x, sub, old, new, column, transition)


@compiled
def _run_forced(drive, whole, p, x, seat, h, substeps, column, transition, held, rising, angles, fine):  # type: ignore[no-untyped-def]
    acting, shown = drive
    varies, dry, turns = F.varies(p), has_friction(p), F.turns(p)
    varies = varies or p[P.STRIBECK] != 0.0  # with the speed
    gain = held[1, 7] - held[1, 0]  # of the relative speed: what a loss of 1 N m takes off it in a step
    memory, friction = (0.0, seat), 0.0
    at = (0.0, p[P.GEAR_RATIO] * x[1])
    if angles.shape[0] > 0:
        at = (angles[0, 0], angles[0, 1])
    f = F.forces(x, memory, at, p)
    for k in range(acting.shape[0]):
        new = acting[max(k - whole, 0)]
        old = acting[max(k - whole - 1, 0)]
        fine[k, 0] = x[0] - x[7]
        fine[k, 1] = x[2]
        fine[k, 2] = F.shaft_torque(x, f, p, shown[k])
        for sub in range(substeps):
            y = _moved(x, sub, old, new, column, transition)
            y = _plus(_plus(_plus(y, held, 0, f[0]), held, 1, f[1]), held, 2, f[2])
            before = x[0] - x[7]
            if dry:
                level = friction_level(before, p)
                friction = mean_friction(before, y[0] - y[7], gain, level)
                y = _plus(y, held, 1, friction)
            if varies:
                part = (sub + 1.0) / substeps
                later = F.angles_at(angles, k, part, x, y, at, h, p) if turns else at
                g = F.forces(y, F.remembered(memory, x, y, h, p), later, p)
                middle = 0.5 * (before + y[0] - y[7])
                y = _plus(_plus(y, rising, 0, g[0] - f[0]), rising, 1, g[1] - f[1])
                y = _plus(y, rising, 2, g[2] - f[2])
                if dry:
                    level = friction_level(middle, p)
                    free = y[0] - y[7] + gain * friction
                    y = _plus(y, held, 1, mean_friction(before, free, gain, level) - friction)
                if turns:
                    at = F.angles_at(angles, k, part, x, y, at, h, p)
                memory = F.remembered(memory, x, y, h, p)
                f = F.forces(y, memory, at, p)
            x = y


@compiled
def _run(torque, dt, vector, start, substeps, transition, column, held, rising, angles, fine):  # type: ignore[no-untyped-def]
    """One model over the whole recording into `fine` (n x 3)."""
    p = as_tuple(vector)
    acting, ends, shown = np.empty(torque.shape[0]), np.empty(torque.shape[0]), np.empty(torque.shape[0])
    _acting(torque, dt, p, acting, ends)
    x = _first_state(p, start, acting[0])
    whole = math.floor(p[P.TORQUE_DELAY] / dt + 1e-9)
    _shown(acting, ends, dt, whole, p, shown)
    drive = (acting, shown)
    if F.varies(p) or has_friction(p) or p[P.FRICTION_OFFSET] != 0.0:
        h, seat = dt / substeps, _first_seat(p, start)
        _run_forced(drive, whole, p, x, seat, h, substeps, column, transition, held, rising, angles, fine)
    else:
        _run_linear(drive, whole, p, x, substeps, column, transition, fine)


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
