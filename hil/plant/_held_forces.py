"""Nonlinear forces of the driveline as inputs of its linear part, for the kernel of many models.

The forces are those of `_equations`, without what is linear in them.
"""

from __future__ import annotations

import math

from hil.core.compiled import inlined
from hil.plant import _slots as P
from hil.plant import _states as X
from hil.plant._backlash import gap_torque, moved_seat
from hil.plant._equations import ROLLING_WIDTH_RAD_S
from hil.plant._friction import friction_level, friction_torque

SLIP, SEAT = range(2)  # of the memory
SHAFT, LOSS, LOAD = range(3)  # of the forces
WHEEL, ROTOR = range(2)  # of the angles
_STANDSTILL_RAD_S = 1e-9  # what rounding leaves of zero


@inlined
def turns(p):  # type: ignore[no-untyped-def]
    """Whether a force follows an angle of turning."""
    return p[P.WHEEL_ORDER_AMPLITUDE] != 0.0 or p[P.MOTOR_ORDER_AMPLITUDE] != 0.0


@inlined
def varies(p):  # type: ignore[no-untyped-def]
    """Whether any force but dry friction depends on the state."""
    shaft = p[P.HALF_GAP] > 0.0 or p[P.HYSTERESIS_STIFFNESS] != 0.0 or p[P.CUBIC] != 0.0
    return shaft or turns(p) or p[P.ROLLING] != 0.0 or p[P.AERO] != 0.0


@inlined
def _tanh(u):  # type: ignore[no-untyped-def]
    """tanh(u) to 1e-10 of itself: the library's takes longer than all the rest of a step."""
    if abs(u) < 0.5:  # continued fraction
        s = u * u
        return u * (945.0 + s * (105.0 + s)) / (945.0 + s * (420.0 + 15.0 * s))
    return math.copysign(1.0, u) if abs(u) > 20.0 else math.tanh(u)


@inlined
def twist_rate(x, p):  # type: ignore[no-untyped-def]
    """Of the shafts, rad/s on the wheel side."""
    return x[X.HOUSING_SPEED] + (x[X.ROTOR_SPEED] - x[X.HOUSING_SPEED]) / p[P.GEAR_RATIO] - x[X.WHEEL_SPEED]


@inlined
def forces(x, memory, at, p):  # type: ignore[no-untyped-def]
    """Extra shaft torque, extra rotor loss but dry friction, and load on the vehicle, in N m.

    `memory` holds what `remembered` returns, `at` the angles of wheel and rotor.
    """
    shaft = 0.0
    if p[P.KIND] != P.RIGID:
        e = x[X.TWIST]
        if p[P.HALF_GAP] > 0.0:
            v = twist_rate(x, p)
            linear = p[P.SHAFT_STIFFNESS] * e + p[P.SHAFT_DAMPING] * v
            e -= memory[SEAT]
            shaft = gap_torque(e, v, memory[SEAT], p) - linear
            if abs(memory[SEAT]) < p[P.HALF_GAP]:
                e = 0.0
        shaft += p[P.CUBIC] * e * e * e + p[P.HYSTERESIS_STIFFNESS] * memory[SLIP]
        if p[P.WHEEL_ORDER_AMPLITUDE] != 0.0:
            angle = p[P.WHEEL_ORDER] * at[WHEEL] + p[P.WHEEL_ORDER_PHASE]
            shaft += p[P.WHEEL_ORDER_AMPLITUDE] * math.sin(angle)
    loss = p[P.FRICTION_OFFSET]
    if p[P.MOTOR_ORDER_AMPLITUDE] != 0.0:
        angle = p[P.MOTOR_ORDER] * at[ROTOR] + p[P.MOTOR_ORDER_PHASE]
        loss -= p[P.MOTOR_ORDER_AMPLITUDE] * math.sin(angle)
    load = 0.0
    if p[P.ROLLING] != 0.0 or p[P.AERO] != 0.0:
        speed = x[X.VEHICLE_SPEED]
        load = p[P.ROLLING] * _tanh(speed / ROLLING_WIDTH_RAD_S) + p[P.AERO] * speed * abs(speed)
    return shaft, loss, load


@inlined
def remembered(memory, old, x, h, p):  # type: ignore[no-untyped-def]
    """Twist of the hysteretic path and seat of the shafts in the gap, rad, after a step of `h` seconds.

    In the step the state goes from `old` to `x`.
    """
    seat = memory[SEAT]
    if p[P.HALF_GAP] > 0.0:
        seat = moved_seat(seat, old[X.TWIST], x[X.TWIST], h, p)
    if p[P.HYSTERESIS_STIFFNESS] == 0.0:
        return memory[SLIP], seat
    slip = memory[SLIP]
    v = 0.5 * (twist_rate(old, p) + twist_rate(x, p))
    largest = p[P.HYSTERESIS_SLIP]
    ratio = slip / largest
    if ratio * v <= 0.0:
        slip += h * v
    else:
        # r' = (v / largest)·(1 - r²) has the solution tanh: no step is too long for it
        rise = _tanh(h * v / largest)
        slip = largest * (ratio + rise) / (1.0 + ratio * rise)
    return min(max(slip, -largest), largest), seat


@inlined
def angles_at(angles, k, part, old, x, at, h, p):  # type: ignore[no-untyped-def]
    """Angles of wheel and rotor in rad at sample `k` + `part`: measured (n x 2), or else as simulated."""
    if angles.shape[0] == 0:
        wheel = at[WHEEL] + 0.5 * h * (old[X.WHEEL_SPEED] + x[X.WHEEL_SPEED])
        return wheel, p[P.GEAR_RATIO] * (x[X.TWIST] + wheel - x[X.HOUSING_ANGLE])
    left = min(k, angles.shape[0] - 2)
    part += k - left
    return (
        angles[left, WHEEL] + part * (angles[left + 1, WHEEL] - angles[left, WHEEL]),
        angles[left, ROTOR] + part * (angles[left + 1, ROTOR] - angles[left, ROTOR]),
    )


@inlined
def shaft_torque(x, f, p, acting):  # type: ignore[no-untyped-def]
    """Torque in N m that a state and its forces show on the wheel side; `acting` before the lag."""
    if p[P.KIND] != P.RIGID:
        return p[P.SHAFT_STIFFNESS] * x[X.TWIST] + p[P.SHAFT_DAMPING] * twist_rate(x, p) + f[SHAFT]
    n = p[P.GEAR_RATIO]
    speed = x[X.ROTOR_SPEED] - x[X.HOUSING_SPEED]
    if p[P.LAG] > 0.0:
        acting = x[X.LAGGED]
    driving = acting - f[LOSS] - p[P.DRAG] * speed - f[LOAD] / n
    direction = speed if abs(speed) > _STANDSTILL_RAD_S else 0.0
    driving -= friction_torque(direction, driving, friction_level(speed, p))
    rotor = driving / (p[P.MOTOR_INERTIA] + p[P.VEHICLE_INERTIA] / (n * n))
    return p[P.VEHICLE_INERTIA] * rotor / n + f[LOAD]
