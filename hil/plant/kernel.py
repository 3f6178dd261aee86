"""The compiled integrator: classical Runge-Kutta at a fixed step, torque held between controller samples.

Dead time is exact: the held torque switches at t_k + delay, and the step grid is laid so that the switch
falls on a step's border. With dry friction, so does the instant at which the rotor stops.
"""

from __future__ import annotations

import math

import numpy as np
from numba.extending import overload
from numba.np.unsafe.ndarray import to_fixed_tuple

from hil.core.runtime.compiled import chosen_by_type, compiled, compiled_without_lock, inlined
from hil.plant import _equations as E
from hil.plant import _laws as L
from hil.plant import sides as S
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._motion import acting_of, chain_of, relative_speed
from hil.plant._tuples import plus, put

# Columns of the kernel's output
OUT_MOTOR_SPEED, OUT_WHEEL_SPEED, OUT_SHAFT_TORQUE, OUT_MOTOR_TORQUE, OUT_VEHICLE_SPEED, OUT_LOAD = range(6)
OUTPUT_COLUMNS = 6
#: Behind them, half of what the left wheel's speed and the left shaft's torque have more than the right's.
OUT_WHEEL_APART, OUT_SHAFT_APART = OUTPUT_COLUMNS, OUTPUT_COLUMNS + 1
# Columns of a start
(
    START_MOTOR_SPEED,
    START_WHEEL_SPEED,
    START_SHAFT_TORQUE,
    START_MOTOR_TORQUE,
    START_WHEEL_ANGLE,
    START_VEHICLE_AHEAD,  # of the wheel, in mid-motion of a tyre between them
    START_TYRE_TWIST,  # beyond what the shaft torque holds
) = range(7)
START_COLUMNS = 7
_PARAMETERS = len(P.SLOTS)
_MEMORIES = len(X.NO_MEMORY)


@inlined
def as_tuple(vector):  # type: ignore[no-untyped-def]
    """The parameter vector by value: the compiler then keeps it in registers and drops what is zero's work.

    Makes the kernel four times as fast as with an array.
    """
    return to_fixed_tuple(vector, _PARAMETERS)


@chosen_by_type
def as_state(array, form):  # type: ignore[no-untyped-def]
    """The moving state and the memories that an array holds, by value; as many moving ones as `form` has."""
    return tuple(array[: len(form)]), tuple(array[len(form) :])


@overload(as_state, jit_options={"error_model": "numpy", "forceinline": True})
def _as_state(array, form):  # type: ignore[no-untyped-def]
    del array
    moving, memories = len(form), _MEMORIES

    def cut(array, form):  # type: ignore[no-untyped-def] # noqa: ARG001
        return to_fixed_tuple(array[:moving], moving), to_fixed_tuple(array[moving:], memories)

    return cut


@compiled
def _after(x, memories, y, p, h):  # type: ignore[no-untyped-def]
    """What effects remember `h` seconds after `x`, once the state is `y`."""
    chain = chain_of(p)
    before, after = E.motion(x, chain, memories, p), E.motion(y, chain, memories, p)
    return L.remembered(before, after, chain, memories, p, h)


@inlined
def _step(x, memories, p, acting, torque, coupled, load, h, direction):  # type: ignore[no-untyped-def]
    """One Runge-Kutta step of `h` seconds; dry friction keeps its direction over it."""
    kept = memories
    k1 = S.derivative(x, kept, p, acting, torque, coupled, load, direction)
    y = plus(x, 0.5 * h, k1)
    if acting.memory:
        kept = _after(x, memories, y, p, 0.5 * h)
    k2 = S.derivative(y, kept, p, acting, torque, coupled, load, direction)
    k3 = S.derivative(plus(x, 0.5 * h, k2), kept, p, acting, torque, coupled, load, direction)
    y = plus(x, h, k3)
    if acting.memory:
        kept = _after(x, memories, y, p, h)
    k4 = S.derivative(y, kept, p, acting, torque, coupled, load, direction)
    y = plus(plus(plus(plus(x, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4)
    return y, kept


@compiled
def _steps(x, memories, p, torque, coupled, load, duration, count):  # type: ignore[no-untyped-def]
    """`count` steps over `duration` seconds with constant inputs.

    A step in which dry friction stops the rotor is cut there: it then sticks or turns the other way.
    """
    acting = acting_of(p)
    whole = duration / count
    h, done, cut = whole, 0, False
    while done < count:
        before = relative_speed(x)
        y, kept = _step(x, memories, p, acting, torque, coupled, load, h, before)
        after = relative_speed(y)
        if cut:
            x, memories = put(y, X.ROTOR_SPEED, y[X.HOUSING_SPEED]), kept
            h, cut = whole - h, False
        elif before * after < 0.0 and acting.dry:
            h, cut = h * before / (before - after), True
        else:
            x, memories = y, kept
            h, done = whole, done + 1
    return x, memories


@compiled
def _hold(x, memories, p, slewed, wanted, coupled, load, duration, longest_step):  # type: ignore[no-untyped-def]
    """Advance with the wanted torque held; the slew limit, if any, moves once a step."""
    count = max(1, math.ceil(duration / longest_step - 1e-9))
    limit = L.steepest(p)
    slews = limit != math.inf and slewed != wanted
    parts, steps = (count, 1) if slews else (1, count)
    h = duration / parts
    for _ in range(parts):
        moved, acting = wanted, wanted
        if slews:
            reach = limit * h
            moved = slewed + min(max(wanted - slewed, -reach), reach)
            acting = 0.5 * (slewed + moved)
        x, memories = _steps(x, memories, p, acting, coupled, load, h, steps)
        slewed = moved
    return x, memories, slewed


@compiled
def sample(x, memories, p, slewed, old, new, late, dt, coupled, load, longest_step):  # type: ignore[no-untyped-def]
    """One controller sample: `old` torque acts for `late` seconds, then `new` until `dt`."""
    if late > 0.0:
        wanted = L.limited(L.shaped(old, p), relative_speed(x), p)
        x, memories, slewed = _hold(x, memories, p, slewed, wanted, coupled, load, late, longest_step)
    if late < dt:
        wanted = L.limited(L.shaped(new, p), relative_speed(x), p)
        x, memories, slewed = _hold(x, memories, p, slewed, wanted, coupled, load, dt - late, longest_step)
    return x, memories, slewed


@compiled
def outputs(x, memories, p, slewed, coupled, load, row):  # type: ignore[no-untyped-def]
    """Fill `row` with the measurable quantities of a state."""
    chain, acting = chain_of(p), acting_of(p)
    m = E.motion(x, chain, memories, p)
    torque = x[X.LAGGED] if chain.torque_lag > 0.0 else slewed
    outside = load
    if coupled:
        outside += L.vehicle_load(m, chain, memories, p)
    row[OUT_MOTOR_SPEED] = relative_speed(x)
    row[OUT_WHEEL_SPEED] = x[X.WHEEL_SPEED]
    if chain.kind == P.RIGID:
        rotor = E.rigid_acceleration(x, m, chain, memories, p, acting, torque, outside, relative_speed(x))
        row[OUT_SHAFT_TORQUE] = chain.vehicle_inertia * rotor / chain.gear_ratio + outside
    else:
        row[OUT_SHAFT_TORQUE] = E.shaft_torque(m, chain, memories, p, acting)
    row[OUT_MOTOR_TORQUE] = torque
    row[OUT_VEHICLE_SPEED] = x[X.VEHICLE_SPEED]
    row[OUT_LOAD] = outside
    if coupled and chain.kind == P.THREE_INERTIA:
        row[OUT_LOAD] = E.tyre_torque(x, m, chain, memories, p, acting) + load


@compiled
def initial_state(p, motor_speed, wheel_speed, shaft_torque, motor_torque, wheel_angle):  # type: ignore[no-untyped-def]
    """State and memories that show the given speeds (rad/s) and torques (N m), the road coupling at rest."""
    chain = chain_of(p)
    memories, twist = L.initial(shaft_torque, chain, p)
    memories = L.turned(motor_speed, chain, memories, p)
    if chain.kind != P.RIGID:
        twist += shaft_torque / chain.shaft_stiffness
    tyre = 0.0
    if chain.kind == P.THREE_INERTIA:
        tyre = shaft_torque / chain.tyre_stiffness
    if chain.kind == P.RIGID:
        wheel_speed = motor_speed / chain.gear_ratio
    x = put(put(X.AT_REST, X.ROTOR_SPEED, motor_speed), X.TWIST, twist)
    x = put(put(x, X.WHEEL_SPEED, wheel_speed), X.TYRE_TWIST, tyre)
    x = put(put(x, X.VEHICLE_SPEED, wheel_speed), X.WHEEL_ANGLE, wheel_angle)
    return put(x, X.LAGGED, motor_torque), memories


@compiled_without_lock
def run(torque, load, coupled, dt, vector, start, longest_step, out, beside=()):  # type: ignore[no-untyped-def]
    """Replay `torque` (n samples, held for `dt` each) into `out` (n x OUTPUT_COLUMNS).

    `beside` are the states at rest that a model has beside those of the lumped axle (`sides.form_of`). `load`
    (n) brakes the wheels; over a sample the mean of both its ends acts. `start` has the columns START_…; its
    motor torque has acted before. `coupled` is given, and not always true, so that the bench's closed loop
    and this share what is compiled.
    """
    p = as_tuple(vector)
    whole = math.floor(p[P.TORQUE_DELAY] / dt + 1e-9)
    late = max(0.0, p[P.TORQUE_DELAY] - whole * dt)
    if late < 1e-9 * dt:
        late = 0.0
    before = start[START_MOTOR_TORQUE]
    slewed = L.limited(L.shaped(before, p), start[START_MOTOR_SPEED], p)
    lumped, memories = initial_state(
        p,
        start[START_MOTOR_SPEED],
        start[START_WHEEL_SPEED],
        start[START_SHAFT_TORQUE],
        slewed,
        start[START_WHEEL_ANGLE],
    )
    if p[P.KIND] == P.THREE_INERTIA:
        lumped = put(lumped, X.VEHICLE_SPEED, lumped[X.VEHICLE_SPEED] + start[START_VEHICLE_AHEAD])
        lumped = put(lumped, X.TYRE_TWIST, lumped[X.TYRE_TWIST] + start[START_TYRE_TWIST])
    x = lumped + beside
    for k in range(torque.shape[0]):
        outputs(x, memories, p, slewed, coupled, load[k], out[k])
        if out.shape[1] > OUTPUT_COLUMNS:
            apart, twisted, _, _ = S.differences(x, memories, p, coupled)
            out[k, OUT_WHEEL_APART], out[k, OUT_SHAFT_APART] = apart, twisted
        new = torque[k - whole] if k >= whole else before
        old = torque[k - whole - 1] if k > whole else before
        side = 0.25 * (load[k] + load[min(k + 1, load.shape[0] - 1)])
        brakes = S.loads(x, side, side)
        x, memories, slewed = sample(
            x, memories, p, slewed, old, new, late, dt, coupled, brakes, longest_step
        )


def empty_output(samples: int, sides: bool = False) -> np.ndarray:
    """Room for the output of `run`, with what the `sides` differ by behind it: OUT_…_APART."""
    return np.empty((samples, OUTPUT_COLUMNS + 2 * sides))
