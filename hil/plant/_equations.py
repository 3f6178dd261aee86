"""Equations of motion of the driveline, with every effect of the registry, for the stepping kernel.

Chain (seed: three-inertia reading of (14)-(16)): rotor - gear N - half shafts - wheel and dyno rotor -
tyre/road coupling - vehicle. The housing may turn on its bushes; the motor speed is rotor against housing.
Wheel-side quantities are sums of both sides.
"""

from __future__ import annotations

from hil.core.runtime.compiled import inlined
from hil.plant import _laws as L
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._motion import chain_of, motion_of, relative_speed
from hil.plant._stick_slip import friction_torque
from hil.plant._tuples import put

_TRACKING_RATE_1_S = 100.0  # how fast the idle vehicle model follows the wheel while the dyno leads


@inlined
def motion(x, chain, memories, p):  # type: ignore[no-untyped-def]
    """What laws get to know of a state with its own angles."""
    rotor_angle = chain.gear_ratio * (x[X.TWIST] + x[X.WHEEL_ANGLE] - x[X.HOUSING_ANGLE])
    return motion_of(x, chain, memories, x[X.WHEEL_ANGLE], rotor_angle, p)


@inlined
def rigid_acceleration(x, m, chain, memories, p, acting, torque, load, direction):  # type: ignore[no-untyped-def]
    """Rotor acceleration in rad/s² of the one-mass model, with a wheel-side load in N m."""
    n = chain.gear_ratio
    inertia = chain.motor_inertia + chain.vehicle_inertia / (n * n)
    speed = relative_speed(x)
    driving = torque - chain.viscous_drag * speed - load / n
    if acting.loss:
        driving -= L.rotor_loss(m, chain, memories, p)
    if acting.dry:
        driving -= friction_torque(direction, driving, L.dry_friction(m, chain, memories, p))
    return driving / inertia


@inlined
def shaft_torque(m, chain, memories, p, acting):  # type: ignore[no-untyped-def]
    """T_s in N m: stiffness, damping, and what effects add."""
    torque = chain.shaft_stiffness * m.twist + chain.shaft_damping * m.twist_rate
    if acting.shaft:
        torque += L.shaft_force(m, chain, memories, p)
    return torque


@inlined
def tyre_torque(x, m, chain, memories, p, acting):  # type: ignore[no-untyped-def]
    """Torque that the tyre/road coupling takes from the wheel, in N m."""
    slip = x[X.WHEEL_SPEED] - x[X.VEHICLE_SPEED]
    torque = chain.tyre_stiffness * x[X.TYRE_TWIST] + chain.tyre_damping * slip
    if acting.tyre:
        torque += L.tyre_force(m, chain, memories, p)
    return torque


@inlined
def derivative(x, memories, p, acting, torque, coupled, load, direction):  # type: ignore[no-untyped-def]
    """dx/dt; `torque` acts on the rotor (before the lag), `load` on the wheel; the vehicle only if coupled.

    `acting` is that of `acting_of`. Dry friction acts against `direction`, which a whole step shares: the
    sign of the speed, 0 at standstill.
    """
    chain = chain_of(p)
    m = motion(x, chain, memories, p)
    lagged = 0.0
    if chain.torque_lag > 0.0:
        lagged = (torque - x[X.LAGGED]) / chain.torque_lag
        torque = x[X.LAGGED]
    slope = put(put(X.AT_REST, X.LAGGED, lagged), X.WHEEL_ANGLE, x[X.WHEEL_SPEED])
    n = chain.gear_ratio
    resistance = 0.0
    if coupled and acting.load:
        resistance = L.vehicle_load(m, chain, memories, p)
    outside = load + resistance
    if chain.kind == P.RIGID:
        rotor = rigid_acceleration(x, m, chain, memories, p, acting, torque, outside, direction)
        slope = put(put(slope, X.ROTOR_SPEED, rotor), X.WHEEL_SPEED, rotor / n)
        return put(slope, X.VEHICLE_SPEED, rotor / n)
    shaft = shaft_torque(m, chain, memories, p, acting)
    driving = torque - chain.viscous_drag * relative_speed(x) - shaft / n
    if acting.loss:
        driving -= L.rotor_loss(m, chain, memories, p)
    bushes = 0.0
    if chain.housing_inertia > 0.0:
        bushes = chain.mount_stiffness * x[X.HOUSING_ANGLE] + chain.mount_damping * x[X.HOUSING_SPEED]
    sticks = False
    if acting.dry:
        holding = driving
        if chain.housing_inertia > 0.0:  # then both turn as one
            share = chain.motor_inertia / (chain.motor_inertia + chain.housing_inertia)
            holding += share * (shaft + bushes)
        friction = friction_torque(direction, holding, L.dry_friction(m, chain, memories, p))
        sticks = direction == 0.0 and friction == holding
        driving -= friction
    rotor = driving / chain.motor_inertia
    housing = 0.0
    if chain.housing_inertia > 0.0:
        housing = -(driving + shaft + bushes) / chain.housing_inertia
    if sticks:
        rotor = housing
    if chain.kind == P.TWO_INERTIA:
        wheel = (shaft - outside) / chain.vehicle_inertia
        tyre, vehicle = 0.0, wheel
    elif coupled:
        road = tyre_torque(x, m, chain, memories, p, acting)
        wheel = (shaft - road - load) / chain.wheel_inertia
        tyre = x[X.WHEEL_SPEED] - x[X.VEHICLE_SPEED]
        if acting.tyre:
            tyre += L.tyre_rate(m, chain, memories, p)
        vehicle = (road - resistance) / chain.vehicle_inertia
    else:
        wheel = (shaft - load) / chain.wheel_inertia
        tyre = -_TRACKING_RATE_1_S * x[X.TYRE_TWIST]
        vehicle = wheel + _TRACKING_RATE_1_S * (x[X.WHEEL_SPEED] - x[X.VEHICLE_SPEED])
    slope = put(put(slope, X.ROTOR_SPEED, rotor), X.TWIST, m.twist_rate)
    slope = put(put(slope, X.WHEEL_SPEED, wheel), X.TYRE_TWIST, tyre)
    slope = put(put(slope, X.VEHICLE_SPEED, vehicle), X.HOUSING_ANGLE, x[X.HOUSING_SPEED])
    return put(slope, X.HOUSING_SPEED, housing)
