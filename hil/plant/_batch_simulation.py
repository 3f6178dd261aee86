"""Replays one torque through many models at once, averaged over blocks of samples: for fits.

Same equations as the step-by-step kernel; the linear part moves exactly, the nonlinear forces are inputs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from hil.core.model import TransferFunction
from hil.core.runtime.compiled import compiled, compiled_without_lock, inlined
from hil.core.runtime.thread_map import map_on_threads, threads
from hil.plant import _forces as F
from hil.plant import _laws as L
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._functions import respond_many
from hil.plant._held_linear import step_matrices
from hil.plant._motion import acting_of, chain_of, motion_of, relative_speed
from hil.plant._packed_sets import (
    BY_ANGLE,
    CONSTANT,
    SHAFT,
    SPEED,
    TYRE,
    VEHICLE,
    WHEEL,
    begins_of,
    parts_of,
)
from hil.plant._stick_slip import mean_friction
from hil.plant._torque_path import over_samples, slewed_over
from hil.plant._tuples import plus, plus_product, plus_row, put
from hil.plant.kernel import as_tuple
from hil.plant.sensors import COLUMNS, GAIN, record

Array = npt.NDArray[np.float64]

CHANNELS = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
_PARTS_PER_THREAD = 4


@dataclass(frozen=True)
class Led:
    """Speeds of rotor and wheel (n x 2, rad/s; NaN where not recorded) that lead a simulation.

    At every sample `share` of what is between them and the simulated ones is made up for.
    """

    speeds: Array
    share: float


_NOT_LED = (np.zeros((1, 2)), 0.0)


def ideal_sensors(sets: int) -> Array:
    """Sensors that read the truth, for each of the three channels: sets x 3 x a sensor's numbers."""
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
    load_nm: Array | None = None,
    functions: Mapping[str, TransferFunction] | None = None,
    before_nm: float | None = None,
    led: Led | None = None,
) -> Array:
    """Channels of many packed models for one torque request, each the mean of `block` samples.

    Args:
        parameters: sets x slots, from `pack`.
        torque_nm: shape (n,), held for `dt` seconds each.
        starts: sets x 3: motor speed, wheel speed (rad/s), shaft torque (N m); or sets x 5, where three
            inertias begin in mid-motion: vehicle less wheel speed (rad/s), and the tyre's twist beyond what
            the shaft torque holds (rad).
        sensors: sets x 3 channels x a sensor's numbers (`_sensors.SENSOR`), as from `ideal_sensors`.
        angles: n x 2, wheel and rotor angle in rad that ripples follow (as measured); when left out, the
            simulated ones.
        load_nm: shape (n,), brakes the wheels (the load where there is no wheel), straight from sample to
            sample; none when left out.
        functions: of a transfer-function model; only torque path and sensors of `parameters` count then, and
            there was no torque before.
        before_nm: has acted since long before; the first value of `torque_nm` when left out.
        led: speeds that lead all models; none when left out.

    Returns:
        sets x (n // block) x 3, in the order of `CHANNELS`. A diverged set shows as NaN or huge numbers.
    """
    if functions:
        return respond_many(functions, parameters, torque_nm, dt, starts, sensors, block)
    sets = len(parameters)
    begin = begins_of(parameters, starts)
    substeps, varies = parts_of(parameters, dt)
    most = int(substeps.max())
    transition = np.zeros((sets, X.LINEAR_STATES, X.LINEAR_STATES))
    torque = np.zeros((sets, 2 * most, X.LINEAR_STATES))
    held, rising = (np.zeros((sets, F.COUNT, X.LINEAR_STATES)) for _ in range(2))
    for index, p in enumerate(parameters):
        used = int(substeps[index])
        matrices = _matrices(p[: P.CHAIN].tobytes(), dt, used)
        transition[index], held[index], rising[index] = matrices[0], matrices[2], matrices[3]
        torque[index, : 2 * used] = matrices[1].reshape(-1, X.LINEAR_STATES)
    out = np.empty((sets, len(torque_nm) // block, len(CHANNELS)))
    before = torque_nm[0] if before_nm is None else before_nm
    torque_nm = np.concatenate([[before], torque_nm])
    parameters, sensors = np.ascontiguousarray(parameters), np.ascontiguousarray(sensors, dtype=float)
    angles = np.zeros((0, 2)) if angles is None else np.ascontiguousarray(angles, dtype=float)
    load_nm = None if load_nm is None else np.ascontiguousarray(load_nm, dtype=float)
    lead = _NOT_LED if led is None else (np.ascontiguousarray(led.speeds, dtype=float), led.share)

    def run(part: slice) -> None:
        _run_all(
            torque_nm,
            dt,
            parameters[part],
            begin[part],
            sensors[part],
            block,
            substeps[part],
            varies[part],
            (transition[part], torque[part], held[part], rising[part]),
            (angles, lead),
            load_nm,
            out[part],
        )

    map_on_threads(run, _shared_out(sets))
    return out


def _shared_out(sets: int) -> list[slice]:
    """Parts of about the same number of sets: a few for each thread, as some sets take longer."""
    parts = min(sets, _PARTS_PER_THREAD * threads())
    ends = [sets * part // parts for part in range(parts + 1)]
    return [slice(*both) for both in pairwise(ends)]


@lru_cache(maxsize=512)
def _matrices(linear: bytes, dt: float, substeps: int) -> tuple[Array, Array, Array, Array]:
    p = np.zeros(len(P.SLOTS))
    p[: P.CHAIN] = np.frombuffer(linear)
    return step_matrices(p, dt, substeps)


@compiled
def _shown(acting, ends, dt, whole, p, out):  # type: ignore[no-untyped-def]
    """The delayed torque at each sample's instant: what a rigid axle's shaft torque shows of it."""
    limit = L.steepest(p)
    reach = (1.0 + whole - p[P.TORQUE_DELAY] / dt) * limit * dt
    for k in range(out.shape[0]):
        now = max(k - whole, 0)
        out[k] = acting[now]
        if limit < math.inf:
            before = ends[max(now - 1, 0)]
            gap = ends[now] - before
            out[k] = before + math.copysign(min(abs(gap), reach), gap)


@compiled
def _first_state(p, start, acting):  # type: ignore[no-untyped-def]
    """State and memories that show a start."""
    memories, twist = L.initial(start[SHAFT], chain_of(p), p)
    memories = L.turned(start[SPEED], chain_of(p), memories, p)
    x = put(put(X.LINEAR_AT_REST, X.LAGGED, acting), X.ROTOR_SPEED, start[SPEED])
    if p[P.KIND] == P.RIGID:
        wheel = start[SPEED] / p[P.GEAR_RATIO]
        return put(put(x, X.WHEEL_SPEED, wheel), X.VEHICLE_SPEED, wheel), memories
    twist += start[SHAFT] / p[P.SHAFT_STIFFNESS]
    x = put(put(x, X.TWIST, twist), X.WHEEL_SPEED, start[WHEEL])
    if p[P.KIND] != P.THREE_INERTIA:
        return put(x, X.VEHICLE_SPEED, start[WHEEL]), memories
    x = put(x, X.TYRE_TWIST, start[SHAFT] / p[P.TYRE_STIFFNESS] + start[TYRE])
    return put(x, X.VEHICLE_SPEED, start[WHEEL] + start[VEHICLE]), memories


@inlined
def _moved(x, sub, old, new, column, transition):  # type: ignore[no-untyped-def]
    """State after substep `sub` from `x` without any nonlinear force."""
    y = plus_row(X.LINEAR_AT_REST, old, column, 2 * sub)
    y = plus_row(y, new, column, 2 * sub + 1)
    return plus_product(y, x, transition)


@compiled
def _run_linear(drive, whole, p, x, substeps, column, transition, fine):  # type: ignore[no-untyped-def]
    acting, shown, _ = drive
    for k in range(shown.shape[0]):
        new = acting[max(k + 1 - whole, 0)]
        old = acting[max(k - whole, 0)]
        fine[k, SPEED] = relative_speed(x)
        fine[k, WHEEL] = x[X.WHEEL_SPEED]
        fine[k, SHAFT] = F.shaft_torque(x, F.NONE, 0.0, p, shown[k], False)
        for sub in range(substeps):
            x = _moved(x, sub, old, new, column, transition)


@inlined
def _pushed(y, f, held):  # type: ignore[no-untyped-def]
    """State with the effect of forces, by the rows of `held` (or `rising`)."""
    return plus_product(y, f, held)


@inlined
def _braked(y, begins, rises, held, rising, has_wheel):  # type: ignore[no-untyped-def]
    """State with the effect of a torque that brakes the wheels, which changes by `rises` over a step."""
    y = plus_row(plus_row(y, begins, held, F.LOAD), rises, rising, F.LOAD)
    if has_wheel:  # what the tyre takes beside brakes the wheel and pushes the vehicle
        y = plus_row(plus_row(y, begins, held, F.TYRE), rises, rising, F.TYRE)
    return y


@inlined
def _led(x, lead, k, ends):  # type: ignore[no-untyped-def]
    """State at sample `k`, where one `ends`, nearer to the speeds that lead it."""
    speeds, share = lead
    share = share if ends and k < speeds.shape[0] else 0.0
    k = min(k, speeds.shape[0] - 1)
    motor, wheel = speeds[k, 0] - relative_speed(x), speeds[k, 1] - x[X.WHEEL_SPEED]
    motor = share * motor if math.isfinite(motor) else 0.0
    wheel = share * wheel if math.isfinite(wheel) else 0.0
    x = put(put(x, X.ROTOR_SPEED, x[X.ROTOR_SPEED] + motor), X.WHEEL_SPEED, x[X.WHEEL_SPEED] + wheel)
    return put(x, X.VEHICLE_SPEED, x[X.VEHICLE_SPEED] + wheel)


@compiled
def _run_forced(drive, whole, p, first, varies, h, substeps, matrices, recorded, load, fine):  # type: ignore[no-untyped-def]
    # What is none is added all the same, as zero: a state that goes two ways falls apart into scalars.
    asked, shown, torque = drive
    transition, column, held, rising = matrices
    angles, lead = recorded
    x, memories = first
    chain, acting = chain_of(p), acting_of(p)
    turns, leaps, limits = L.turns(p), L.leaps(p), L.limits(p)
    reach = L.steepest(p) * h * substeps
    given = slewed = L.limited(asked[0], relative_speed(x), p)
    known = varies == BY_ANGLE and angles.shape[0] > 0  # forces are, before the motion is
    gain = held[F.LOSS, X.HOUSING_SPEED] - held[F.LOSS, X.ROTOR_SPEED]
    friction = 0.0
    at = F.first_angles(angles, x, p)
    m = motion_of(x, chain, memories, at[F.WHEEL], at[F.ROTOR], p)
    f = F.forces(m, chain, memories, p, acting)
    has_wheel = chain.kind == P.THREE_INERTIA
    brakes, rises, foreseen = 0.0, 0.0, 0.0
    for k in range(shown.shape[0]):
        if load is not None:
            brakes = load[k]
            rises = (load[min(k + 1, load.shape[0] - 1)] - brakes) / substeps
        new = asked[max(k + 1 - whole, 0)]
        old = asked[max(k - whole, 0)]
        instant = shown[k]
        if limits:  # by the speed, as the motion is known
            wanted = L.limited(L.shaped(torque[max(k + 1 - whole, 0)], p), relative_speed(x), p)
            instant = old = given
            given, slewed = slewed_over(wanted, slewed, reach)
            new = given
        fine[k, SPEED] = relative_speed(x)
        fine[k, WHEEL] = x[X.WHEEL_SPEED]
        fine[k, SHAFT] = F.shaft_torque(x, f, brakes, p, instant, acting.dry)
        for sub in range(substeps):
            y = plus(_pushed(X.LINEAR_AT_REST, f, held), 1.0, _moved(x, sub, old, new, column, transition))
            if load is not None:
                y = _braked(y, brakes + sub * rises, rises, held, rising, has_wheel)
            y = plus_row(y, foreseen, rising, F.SHAFT)
            before = relative_speed(x)
            if acting.dry:
                level = F.level(before, chain, memories, p)
                friction = mean_friction(before, relative_speed(y), gain, level)
            y = plus_row(y, friction, held, F.LOSS)
            ends = sub == substeps - 1
            if varies == CONSTANT:
                x = _led(y, lead, k + 1, ends)
                continue
            part = (sub + 1.0) / substeps
            later = F.angles_at(angles, k, part, x, y, at, h, p) if turns else at
            n = motion_of(y, chain, memories, later[F.WHEEL], later[F.ROTOR], p)
            kept = memories
            if acting.memory:
                kept = L.remembered(m, n, chain, memories, p, h)
                n = motion_of(y, chain, kept, later[F.WHEEL], later[F.ROTOR], p)
            middle = 0.5 * (before + relative_speed(y))
            then = F.forces(n, chain, kept, p, acting)
            changed = F.change(then, f)
            more, rise = 0.0, 0.0
            if leaps and kept != memories:  # what stays where it was does not leap
                more, rise = L.shaft_leap(m, n, chain, memories, p, h)
            y = _pushed(y, changed, rising)
            y = plus_row(plus_row(y, more, held, F.SHAFT), rise - foreseen, rising, F.SHAFT)
            if leaps:
                foreseen = changed[F.SHAFT] if more == 0.0 and rise == 0.0 else 0.0
            again = friction
            if acting.dry:
                level = F.level(middle, chain, memories, p)
                again = mean_friction(before, relative_speed(y) + gain * friction, gain, level)
            y = plus_row(y, again - friction, held, F.LOSS)
            y = _led(y, lead, k + 1, ends)
            if known:
                at, f = later, then
            else:
                if turns:
                    at = F.angles_at(angles, k, part, x, y, at, h, p)
                n = motion_of(y, chain, memories, at[F.WHEEL], at[F.ROTOR], p)
                if acting.memory:
                    memories = L.remembered(m, n, chain, memories, p, h)
                    n = motion_of(y, chain, memories, at[F.WHEEL], at[F.ROTOR], p)
                m = n
                f = F.forces(m, chain, memories, p, acting)
            x = y


@compiled
def _run_by_angle(drive, whole, p, first, h, substeps, matrices, angles, fine):  # type: ignore[no-untyped-def]
    """As `_run_forced`, by forces on shaft and rotor that measured angles tell before the motion is."""
    asked, shown, _ = drive
    transition, column, held, rising = matrices
    x, memories = first
    chain, acting = chain_of(p), acting_of(p)
    at = F.first_angles(angles, x, p)
    f = F.forces(motion_of(x, chain, memories, at[F.WHEEL], at[F.ROTOR], p), chain, memories, p, acting)
    for k in range(shown.shape[0]):
        new = asked[max(k + 1 - whole, 0)]
        old = asked[max(k - whole, 0)]
        fine[k, SPEED] = relative_speed(x)
        fine[k, WHEEL] = x[X.WHEEL_SPEED]
        fine[k, SHAFT] = F.shaft_torque(x, f, 0.0, p, shown[k], False)
        for sub in range(substeps):
            at = F.angles_at(angles, k, (sub + 1.0) / substeps, x, x, at, h, p)
            m = motion_of(x, chain, memories, at[F.WHEEL], at[F.ROTOR], p)
            ends = F.forces(m, chain, memories, p, acting)
            y = _moved(x, sub, old, new, column, transition)
            y = plus_row(plus_row(y, f[F.SHAFT], held, F.SHAFT), ends[F.SHAFT] - f[F.SHAFT], rising, F.SHAFT)
            x = plus_row(plus_row(y, f[F.LOSS], held, F.LOSS), ends[F.LOSS] - f[F.LOSS], rising, F.LOSS)
            f = ends


@compiled
def _run(torque, dt, vector, start, substeps, varies, matrices, recorded, load, fine):  # type: ignore[no-untyped-def]
    """One model over a recording into `fine` (n x 3); `torque` (n + 1) begins with what acted before."""
    p = as_tuple(vector)
    angles, lead = recorded
    acting, ends, shown = np.empty(torque.shape[0]), np.empty(torque.shape[0]), np.empty(fine.shape[0])
    over_samples(torque, dt, p, acting, ends)
    first = _first_state(p, start, L.limited(acting[0], start[SPEED], p))
    whole = math.floor(p[P.TORQUE_DELAY] / dt + 1e-9)
    _shown(acting, ends, dt, whole, p, shown)
    drive = (acting, shown, torque)
    limits = L.limits(p)
    h = dt / substeps
    known = varies == BY_ANGLE and angles.shape[0] > 0 and load is None
    is_led = lead[1] > 0.0
    does = acting_of(p)
    if known and not (does.dry or does.load or does.tyre or does.memory or limits or is_led):
        _run_by_angle(drive, whole, p, first, h, substeps, matrices, angles, fine)
    elif varies != CONSTANT or L.pushes(p) or limits or load is not None or is_led:
        _run_forced(drive, whole, p, first, varies, h, substeps, matrices, recorded, load, fine)
    else:
        _run_linear(drive, whole, p, first[0], substeps, matrices[1], matrices[0], fine)


@inlined
def _alike(rows, s):  # type: ignore[no-untyped-def]
    """Whether a row is the one before it."""
    for i in range(rows.shape[1]):  # noqa: SIM110 - no generators in compiled code
        if rows[s, i] != rows[s - 1, i]:
            return False
    return True


@compiled_without_lock
def _run_all(torque, dt, parameters, starts, sensors, block, substeps, varies, matrices, recorded, load, out):  # type: ignore[no-untyped-def]
    transition, column, held, rising = matrices
    fine = np.empty((torque.shape[0] - 1, 3))
    for s in range(parameters.shape[0]):
        # sets that differ in their sensors alone move alike
        if s == 0 or not (_alike(parameters, s) and _alike(starts, s)):
            _run(
                torque,
                dt,
                parameters[s],
                starts[s],
                substeps[s],
                varies[s],
                (transition[s], column[s], held[s], rising[s]),
                recorded,
                load,
                fine,
            )
        for channel in range(fine.shape[1]):
            record(fine[:, channel], sensors[s, channel], dt, block, out[s, :, channel])
