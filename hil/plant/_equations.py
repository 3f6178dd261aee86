"""Equations of motion of the driveline, with every effect of the registry, for the compiled kernel.

Chain (seed: three-inertia reading of (14)-(16)): rotor - gear N - half shafts - wheel and dyno rotor -
tyre/road coupling - vehicle. The housing may turn on its bushes; the motor speed is rotor against housing.
Wheel-side quantities are sums of both sides.
"""

from __future__ import annotations

import math

from hil.core.compiled import compiled, inlined
from hil.plant import _slots as P
from hil.plant import _states as X
from hil.plant._backlash import gap_torque
from hil.plant._friction import friction_level, friction_torque, has_friction
from hil.plant._tuples import put

# Width of a smooth sign function: small against any speed of interest, large enough for 0.1 ms steps.
ROLLING_WIDTH_RAD_S = 0.05
_TRACKING_RATE_1_S = 100.0  # how fast the idle vehicle model follows the wheel while the dyno leads
STATES = X.ALL_STATES


@compiled
def shaft_torque(x, p):  # type: ignore[no-untyped-def]
    """T_s in N m from the state: stiffness (backlash, cubic), damping, hysteresis, wheel-order ripple."""
    v = x[X.HOUSING_SPEED] + (x[X.ROTOR_SPEED] - x[X.HOUSING_SPEED]) / p[P.GEAR_RATIO] - x[X.WHEEL_SPEED]
    e = x[X.TWIST]
    if p[P.HALF_GAP] > 0.0:
        e -= x[X.SEAT]
        torque = gap_torque(e, v, x[X.SEAT], p)
        if abs(x[X.SEAT]) < p[P.HALF_GAP]:
            e = 0.0
    else:
        torque = p[P.SHAFT_STIFFNESS] * e + p[P.SHAFT_DAMPING] * v
    torque += p[P.CUBIC] * e * e * e + p[P.HYSTERESIS_STIFFNESS] * x[X.SLIP]
    if p[P.WHEEL_ORDER_AMPLITUDE] != 0.0:
        torque += p[P.WHEEL_ORDER_AMPLITUDE] * math.sin(
            p[P.WHEEL_ORDER] * x[X.WHEEL_ANGLE] + p[P.WHEEL_ORDER_PHASE]
        )
    return torque


@compiled
def relative_speed(x):  # type: ignore[no-untyped-def]
    """Rotor against housing in rad/s: what the motor's sensor sees and what friction acts on."""
    return x[X.ROTOR_SPEED] - x[X.HOUSING_SPEED]


@compiled
def smooth_losses(x, p):  # type: ignore[no-untyped-def]
    """Drag and ripple on the rotor in N m, against positive motion: all losses but dry friction."""
    loss = p[P.DRAG] * relative_speed(x) + p[P.FRICTION_OFFSET]
    if p[P.MOTOR_ORDER_AMPLITUDE] != 0.0:
        angle = p[P.GEAR_RATIO] * (x[X.TWIST] + x[X.WHEEL_ANGLE] - x[X.HOUSING_ANGLE])
        loss -= p[P.MOTOR_ORDER_AMPLITUDE] * math.sin(p[P.MOTOR_ORDER] * angle + p[P.MOTOR_ORDER_PHASE])
    return loss


@compiled
def running_resistance(speed, p):  # type: ignore[no-untyped-def]
    """Load on the vehicle inertia in N m at a wheel-side speed in rad/s."""
    if p[P.ROLLING] == 0.0 and p[P.AERO] == 0.0:
        return 0.0
    return p[P.ROLLING] * math.tanh(speed / ROLLING_WIDTH_RAD_S) + p[P.AERO] * speed * abs(speed)


@compiled
def tyre_torque(x, p):  # type: ignore[no-untyped-def]
    """Torque that the tyre/road coupling takes from the wheel, in N m."""
    return p[P.TYRE_STIFFNESS] * x[X.TYRE_TWIST] + p[P.TYRE_DAMPING] * (x[X.WHEEL_SPEED] - x[X.VEHICLE_SPEED])


@compiled
def rigid_acceleration(x, p, torque, load, direction):  # type: ignore[no-untyped-def]
    """Rotor acceleration in rad/s² of the one-mass model, with a wheel-side load in N m."""
    n = p[P.GEAR_RATIO]
    inertia = p[P.MOTOR_INERTIA] + p[P.VEHICLE_INERTIA] / (n * n)
    driving = torque - smooth_losses(x, p) - load / n
    if has_friction(p):
        driving -= friction_torque(direction, driving, friction_level(relative_speed(x), p))
    return driving / inertia


@inlined
def derivative(x, p, torque, coupled, load, direction):  # type: ignore[no-untyped-def]
    """dx/dt; `torque` acts on the rotor (before the lag), `load` on the wheel unless coupled.

    Dry friction acts against `direction`, which a whole step shares: the sign of the speed, 0 at standstill.
    """
    lagged = 0.0
    if p[P.LAG] > 0.0:
        lagged = (torque - x[X.LAGGED]) / p[P.LAG]
        torque = x[X.LAGGED]
    slope = put(put(X.AT_REST, X.LAGGED, lagged), X.WHEEL_ANGLE, x[X.WHEEL_SPEED])
    n = p[P.GEAR_RATIO]
    if p[P.KIND] == P.RIGID:
        wheel_load = running_resistance(x[X.WHEEL_SPEED], p) if coupled else load
        rotor = rigid_acceleration(x, p, torque, wheel_load, direction)
        slope = put(put(slope, X.ROTOR_SPEED, rotor), X.WHEEL_SPEED, rotor / n)
        return put(slope, X.VEHICLE_SPEED, rotor / n)
    v = x[X.HOUSING_SPEED] + relative_speed(x) / n - x[X.WHEEL_SPEED]
    shaft = shaft_torque(x, p)
    driving = torque - smooth_losses(x, p) - shaft / n
    bushes = 0.0
    if p[P.HOUSING_INERTIA] > 0.0:
        bushes = p[P.MOUNT_STIFFNESS] * x[X.HOUSING_ANGLE] + p[P.MOUNT_DAMPING] * x[X.HOUSING_SPEED]
    sticks = False
    if has_friction(p):
        holding = driving
        if p[P.HOUSING_INERTIA] > 0.0:  # then both turn as one
            share = p[P.MOTOR_INERTIA] / (p[P.MOTOR_INERTIA] + p[P.HOUSING_INERTIA])
            holding += share * (shaft + bushes)
        friction = friction_torque(direction, holding, friction_level(relative_speed(x), p))
        sticks = direction == 0.0 and friction == holding
        driving -= friction
    rotor = driving / p[P.MOTOR_INERTIA]
    housing = 0.0
    if p[P.HOUSING_INERTIA] > 0.0:
        housing = -(driving + shaft + bushes) / p[P.HOUSING_INERTIA]
    if sticks:
        rotor = housing
    slip = 0.0
    if p[P.HYSTERESIS_STIFFNESS] != 0.0:
        ratio = x[X.SLIP] / p[P.HYSTERESIS_SLIP]
        slip = v if ratio * v <= 0.0 else v * (1.0 - ratio * ratio)
    if p[P.KIND] == P.TWO_INERTIA:
        outside = running_resistance(x[X.WHEEL_SPEED], p) if coupled else load
        wheel = (shaft - outside) / p[P.VEHICLE_INERTIA]
        tyre, vehicle = 0.0, wheel
    elif coupled:
        road = tyre_torque(x, p)
        wheel = (shaft - road) / p[P.WHEEL_INERTIA]
        tyre = x[X.WHEEL_SPEED] - x[X.VEHICLE_SPEED]
        vehicle = (road - running_resistance(x[X.VEHICLE_SPEED], p)) / p[P.VEHICLE_INERTIA]
    else:
        wheel = (shaft - load) / p[P.WHEEL_INERTIA]
        tyre = -_TRACKING_RATE_1_S * x[X.TYRE_TWIST]
        vehicle = wheel + _TRACKING_RATE_1_S * (x[X.WHEEL_SPEED] - x[X.VEHICLE_SPEED])
    slope = put(put(slope, X.ROTOR_SPEED, rotor), X.TWIST, v)
    slope = put(put(slope, X.WHEEL_SPEED, wheel), X.TYRE_TWIST, tyre)
    slope = put(put(slope, X.VEHICLE_SPEED, vehicle), X.SLIP, slip)
    return put(put(slope, X.HOUSING_ANGLE, x[X.HOUSING_SPEED]), X.HOUSING_SPEED, housing)
