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
from hil.plant import _states as X
from hil.plant._equations import relative_speed
from hil.plant._friction import friction_level, has_friction, mean_friction
from hil.plant._held_linear import step_matrices
from hil.plant._kernel import as_tuple
from hil.plant._sensors import COLUMNS, GAIN, record
from hil.plant._tuples import plus_product, plus_row, put

Array = npt.NDArray[np.float64]

CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
SPEED, WHEEL, SHAFT = range(3)  # of the channels, and of a start

_SEATED_NM = 2.0  # a first shaft torque that surely is in contact


def ideal_sensors(sets: int) -> Array:
    """Sensors that read the truth, for each of the three channels: sets x 3 x (gain, offset, delay, step)."""
    sensors = np.zeros((sets, len(CHANNELS), COLUMNS))
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
        sensors: sets x 3 channels x (gain, offset, delay in s, step), as from `ideal_sensors`.
        angles: n x 2, wheel and rotor angle in rad that ripples follow (as measured); when left out, the
            simulated ones.

    Returns:
        sets x (n // block) x 3, in the order of `CHANNELS`. A diverged set shows as NaN or huge numbers.
    """
    sets = len(parameters)
    substeps = np.array([_substeps(p) for p in parameters])
    most = int(substeps.max())
    transition = np.zeros((sets, X.LINEAR_STATES, X.LINEAR_STATES))
    torque = np.zeros((sets, 2 * most, X.LINEAR_STATES))
    held, rising = np.zeros((sets, 3, X.LINEAR_STATES)), np.zeros((sets, 3, X.LINEAR_STATES))
    for index, p in enumerate(parameters):
        used = int(substeps[index])
        matrices = _matrices(p[P.LINEAR].tobytes(), dt, used)
        transition[index], held[index], rising[index] = matrices[0], matrices[2], matrices[3]
        torque[index, : 2 * used] = matrices[1].reshape(-1, X.LINEAR_STATES)
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


_ABRUPT = [P.HALF_GAP, P.HYSTERESIS_STIFFNESS]


@lru_cache(maxsize=512)
def _matrices(linear: bytes, dt: float, substeps: int) -> tuple[Array, Array, Array, Array]:
    p = np.zeros(len(P.SLOTS))
    p[P.LINEAR] = np.frombuffer(linear)
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
    return p[P.HALF_GAP] * min(max(start[SHAFT] / _SEATED_NM, -1.0), 1.0)


@compiled
def _first_state(p, start, acting):  # type: ignore[no-untyped-def]
    x = put(put(X.LINEAR_AT_REST, X.LAGGED, acting), X.ROTOR_SPEED, start[SPEED])
    if p[P.KIND] == P.RIGID:
        wheel = start[SPEED] / p[P.GEAR_RATIO]
        return put(put(x, X.WHEEL_SPEED, wheel), X.VEHICLE_SPEED, wheel)
    twist = start[SHAFT] / p[P.SHAFT_STIFFNESS]
    twist += _first_seat(p, start)
    tyre = start[SHAFT] / p[P.TYRE_STIFFNESS] if p[P.KIND] == P.THREE_INERTIA else 0.0
    x = put(put(x, X.TWIST, twist), X.TYRE_TWIST, tyre)
    return put(put(x, X.WHEEL_SPEED, start[WHEEL]), X.VEHICLE_SPEED, start[WHEEL])


@inlined
def _moved(x, sub, old, new, column, transition):  # type: ignore[no-untyped-def]
    """State after substep `sub` from `x` without any nonlinear force."""
    y = plus_row(X.LINEAR_AT_REST, old, column, 2 * sub)
    y = plus_row(y, new, column, 2 * sub + 1)
    return plus_product(y, x, transition)


@compiled
def _run_linear(drive, whole, p, x, substeps, column, transition, fine):  # type: ignore[no-untyped-def]
    acting, shown = drive
    for k in range(acting.shape[0]):
        new = acting[max(k - whole, 0)]
        old = acting[max(k - whole - 1, 0)]
        fine[k, SPEED] = relative_speed(x)
        fine[k, WHEEL] = x[X.WHEEL_SPEED]
        fine[k, SHAFT] = F.shaft_torque(x, (0.0, 0.0, 0.0), p, shown[k])
        for sub in range(substeps):
            x = _moved(x, sub, old, new, column, transition)


@compiled
def _run_forced(drive, whole, p, x, seat, h, substeps, column, transition, held, rising, angles, fine):  # type: ignore[no-untyped-def]
    acting, shown = drive
    varies, dry, turns = F.varies(p), has_friction(p), F.turns(p)
    varies = varies or p[P.STRIBECK] != 0.0  # with the speed
    gain = held[F.LOSS, X.HOUSING_SPEED] - held[F.LOSS, X.ROTOR_SPEED]
    memory, friction = (0.0, seat), 0.0
    at = (0.0, p[P.GEAR_RATIO] * x[X.TWIST])
    if angles.shape[0] > 0:
        at = (angles[0, F.WHEEL], angles[0, F.ROTOR])
    f = F.forces(x, memory, at, p)
    for k in range(acting.shape[0]):
        new = acting[max(k - whole, 0)]
        old = acting[max(k - whole - 1, 0)]
        fine[k, SPEED] = relative_speed(x)
        fine[k, WHEEL] = x[X.WHEEL_SPEED]
        fine[k, SHAFT] = F.shaft_torque(x, f, p, shown[k])
        for sub in range(substeps):
            y = _moved(x, sub, old, new, column, transition)
            y = plus_row(y, f[F.SHAFT], held, F.SHAFT)
            y = plus_row(plus_row(y, f[F.LOSS], held, F.LOSS), f[F.LOAD], held, F.LOAD)
            before = relative_speed(x)
            if dry:
                level = friction_level(before, p)
                friction = mean_friction(before, relative_speed(y), gain, level)
                y = plus_row(y, friction, held, F.LOSS)
            if varies:
                part = (sub + 1.0) / substeps
                later = F.angles_at(angles, k, part, x, y, at, h, p) if turns else at
                g = F.forces(y, F.remembered(memory, x, y, h, p), later, p)
                middle = 0.5 * (before + relative_speed(y))
                y = plus_row(y, g[F.SHAFT] - f[F.SHAFT], rising, F.SHAFT)
                y = plus_row(y, g[F.LOSS] - f[F.LOSS], rising, F.LOSS)
                y = plus_row(y, g[F.LOAD] - f[F.LOAD], rising, F.LOAD)
                if dry:
                    level = friction_level(middle, p)
                    free = relative_speed(y) + gain * friction
                    y = plus_row(y, mean_friction(before, free, gain, level) - friction, held, F.LOSS)
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
        for channel in range(fine.shape[1]):
            record(fine[:, channel], sensors[s, channel], dt, block, out[s, :, channel])
