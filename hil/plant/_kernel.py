"""The compiled integrator: classical Runge-Kutta at a fixed step, torque held between controller samples.

Dead time is exact: the held torque switches at t_k + delay, and the step grid is laid so that the switch
falls on a step's border. With dry friction, so does the instant at which the rotor stops.
"""

from __future__ import annotations

import math

import numpy as np
from numba.np.unsafe.ndarray import to_fixed_tuple

from hil.core.compiled import compiled, inlined
from hil.plant import _equations as E
from hil.plant import _slots as P
from hil.plant import _states as X
from hil.plant._backlash import moved_seat
from hil.plant._friction import has_friction
from hil.plant._tuples import plus, put

# Columns of the kernel's output
OUT_MOTOR_SPEED, OUT_WHEEL_SPEED, OUT_SHAFT_TORQUE, OUT_MOTOR_TORQUE, OUT_VEHICLE_SPEED, OUT_LOAD = range(6)
OUTPUT_COLUMNS = 6
# Columns of a start
(
    START_MOTOR_SPEED,
    START_WHEEL_SPEED,
    START_SHAFT_TORQUE,
    START_MOTOR_TORQUE,
    START_WHEEL_ANGLE,
) = range(5)
_PARAMETERS = len(P.SLOTS)
_STATES = X.ALL_STATES


@inlined
def as_tuple(vector):  # type: ignore[no-untyped-def]
    """The parameter vector by value: the compiler then keeps it in registers and drops what is zero's work.

    Makes the kernel four times as fast as with an array.
    """
    return to_fixed_tuple(vector, _PARAMETERS)


@inlined
def as_state(array):  # type: ignore[no-untyped-def]
    """The state that an array holds, by value."""
    return to_fixed_tuple(array, _STATES)


@inlined
def _step(x, p, torque, coupled, load, h, direction):  # type: ignore[no-untyped-def]
    """One Runge-Kutta step of `h` seconds; dry friction keeps its direction over it."""
    k1 = E.derivative(x, p, torque, coupled, load, direction)
    k2 = E.derivative(plus(x, 0.5 * h, k1), p, torque, coupled, load, direction)
    k3 = E.derivative(plus(x, 0.5 * h, k2), p, torque, coupled, load, direction)
    k4 = E.derivative(plus(x, h, k3), p, torque, coupled, load, direction)
    y = plus(plus(plus(plus(x, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4)
    if p[P.HALF_GAP] > 0.0 and p[P.KIND] != P.RIGID:
        seat = moved_seat(x[X.SEAT], x[X.TWIST], y[X.TWIST], h, p)
        y = put(y, X.SEAT, seat)
    return y


@compiled
def _steps(x, p, torque, coupled, load, duration, count):  # type: ignore[no-untyped-def]
    """`count` steps over `duration` seconds with constant inputs.

    A step in which dry friction stops the rotor is cut there: it then sticks or turns the other way.
    """
    whole = duration / count
    h, done, cut = whole, 0, False
    while done < count:
        before = E.relative_speed(x)
        y = _step(x, p, torque, coupled, load, h, before)
        after = E.relative_speed(y)
        if cut:
            x = put(y, X.ROTOR_SPEED, y[X.HOUSING_SPEED])
            h, cut = whole - h, False
        elif before * after < 0.0 and has_friction(p):
            h, cut = h * before / (before - after), True
        else:
            x = y
            h, done = whole, done + 1
    return x


@inlined
def shaped(torque, p):  # type: ignore[no-untyped-def]
    """Dead band, then saturation: the parts of the torque path without memory."""
    band = p[P.DEADBAND]
    if band > 0.0:
        torque = math.copysign(max(0.0, abs(torque) - band), torque)
    return min(max(torque, -p[P.SATURATION]), p[P.SATURATION])


@compiled
def _hold(x, p, slewed, wanted, coupled, load, duration, longest_step):  # type: ignore[no-untyped-def]
    """Advance with the wanted torque held; the slew limit, if any, moves once a step."""
    count = max(1, math.ceil(duration / longest_step - 1e-9))
    if p[P.RATE_LIMIT] == math.inf or slewed == wanted:
        return _steps(x, p, wanted, coupled, load, duration, count), wanted
    h = duration / count
    for _ in range(count):
        reach = p[P.RATE_LIMIT] * h
        moved = slewed + min(max(wanted - slewed, -reach), reach)
        x = _steps(x, p, 0.5 * (slewed + moved), coupled, load, h, 1)
        slewed = moved
    return x, slewed


@compiled
def sample(x, p, slewed, old, new, late, dt, coupled, load, longest_step):  # type: ignore[no-untyped-def]
    """One controller sample: `old` torque acts for `late` seconds, then `new` until `dt`."""
    if late > 0.0:
        x, slewed = _hold(x, p, slewed, shaped(old, p), coupled, load, late, longest_step)
    if late < dt:
        x, slewed = _hold(x, p, slewed, shaped(new, p), coupled, load, dt - late, longest_step)
    return x, slewed


@compiled
def outputs(x, p, slewed, coupled, load, row):  # type: ignore[no-untyped-def]
    """Fill `row` with the measurable quantities of a state."""
    acting = x[X.LAGGED] if p[P.LAG] > 0.0 else slewed
    row[OUT_MOTOR_SPEED] = E.relative_speed(x)
    row[OUT_WHEEL_SPEED] = x[X.WHEEL_SPEED]
    if p[P.KIND] == P.RIGID:
        outside = E.running_resistance(x[X.WHEEL_SPEED], p) if coupled else load
        wheel = E.rigid_acceleration(x, p, acting, outside, E.relative_speed(x)) / p[P.GEAR_RATIO]
        row[OUT_SHAFT_TORQUE] = p[P.VEHICLE_INERTIA] * wheel + outside
    else:
        row[OUT_SHAFT_TORQUE] = E.shaft_torque(x, p)
    row[OUT_MOTOR_TORQUE] = acting
    row[OUT_VEHICLE_SPEED] = x[X.VEHICLE_SPEED]
    if coupled and p[P.KIND] == P.THREE_INERTIA:
        row[OUT_LOAD] = E.tyre_torque(x, p)
    elif coupled:
        row[OUT_LOAD] = E.running_resistance(x[X.WHEEL_SPEED], p)
    else:
        row[OUT_LOAD] = load


@compiled
def initial_state(p, motor_speed, wheel_speed, shaft_torque, motor_torque, wheel_angle):  # type: ignore[no-untyped-def]
    """State that shows the given speeds (rad/s) and torques (N m), the road coupling at rest."""
    twist, seat = 0.0, 0.0
    if p[P.KIND] != P.RIGID:
        twist = shaft_torque / p[P.SHAFT_STIFFNESS]
        seat = math.copysign(p[P.HALF_GAP], twist) if twist != 0.0 else 0.0
        twist += seat
    tyre = 0.0
    if p[P.KIND] == P.THREE_INERTIA:
        tyre = shaft_torque / p[P.TYRE_STIFFNESS]
    if p[P.KIND] == P.RIGID:
        wheel_speed = motor_speed / p[P.GEAR_RATIO]
    x = put(put(X.AT_REST, X.ROTOR_SPEED, motor_speed), X.TWIST, twist)
    x = put(put(x, X.WHEEL_SPEED, wheel_speed), X.TYRE_TWIST, tyre)
    x = put(put(x, X.VEHICLE_SPEED, wheel_speed), X.WHEEL_ANGLE, wheel_angle)
    return put(put(x, X.LAGGED, motor_torque), X.SEAT, seat)


@compiled
def run(torque, dt, vector, start, longest_step, out):  # type: ignore[no-untyped-def]
    """Replay `torque` (n samples, held for `dt` each) into `out` (n x OUTPUT_COLUMNS); vehicle coupled.

    `start` has the columns START_…; its motor torque has acted before.
    """
    p = as_tuple(vector)
    whole = math.floor(p[P.TORQUE_DELAY] / dt + 1e-9)
    late = max(0.0, p[P.TORQUE_DELAY] - whole * dt)
    if late < 1e-9 * dt:
        late = 0.0
    before = start[START_MOTOR_TORQUE]
    slewed = shaped(before, p)
    x = initial_state(
        p,
        start[START_MOTOR_SPEED],
        start[START_WHEEL_SPEED],
        start[START_SHAFT_TORQUE],
        slewed,
        start[START_WHEEL_ANGLE],
    )
    for k in range(torque.shape[0]):
        outputs(x, p, slewed, True, 0.0, out[k])
        new = torque[k - whole] if k >= whole else before
        old = torque[k - whole - 1] if k > whole else before
        x, slewed = sample(x, p, slewed, old, new, late, dt, True, 0.0, longest_step)


def empty_output(samples: int) -> np.ndarray:
    """Room for the output of `run`."""
    return np.empty((samples, OUTPUT_COLUMNS))
