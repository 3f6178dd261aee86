"""Forces of effects as inputs of the linear part, for the kernel of many models."""

from __future__ import annotations

from hil.core.runtime.compiled import inlined
from hil.plant import _laws as L
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._motion import chain_of, relative_speed, turning
from hil.plant._stick_slip import friction_torque

# Of the forces: the inputs of `_linear` behind the torque
SHAFT, LOSS, LOAD, TYRE, TYRE_RATE = range(5)
COUNT = 5
NONE = (0.0,) * COUNT
WHEEL, ROTOR = range(2)  # of the angles
_STANDSTILL_RAD_S = 1e-9  # what rounding leaves of zero


@inlined
def forces(m, chain, memories, p, acting):  # type: ignore[no-untyped-def]
    """What effects add: torques in N m, and the tyre's rate in rad/s; dry friction apart.

    `acting` is that of `acting_of`: laws of which none does anything are not asked one by one.
    """
    shaft, loss, load, tyre, rate = NONE
    if acting.shaft:
        shaft = L.shaft_force(m, chain, memories, p)
    if acting.loss:
        loss = L.rotor_loss(m, chain, memories, p)
    if acting.load:
        load = L.vehicle_load(m, chain, memories, p)
    if acting.tyre:
        tyre = L.tyre_force(m, chain, memories, p)
        rate = L.tyre_rate(m, chain, memories, p)
    return shaft, loss, load, tyre, rate


@inlined
def change(new, old):  # type: ignore[no-untyped-def]
    """How forces have changed."""
    return new[0] - old[0], new[1] - old[1], new[2] - old[2], new[3] - old[3], new[4] - old[4]


@inlined
def level(speed, chain, memories, p):  # type: ignore[no-untyped-def]
    """Largest dry friction in N m at a speed of rotor against housing in rad/s."""
    return L.dry_friction(turning(speed), chain, memories, p)


@inlined
def first_angles(angles, x, p):  # type: ignore[no-untyped-def]
    """Angles of wheel and rotor in rad at the first sample: measured (n x 2), or else of the twist."""
    if angles.shape[0] > 0:
        return angles[0, WHEEL], angles[0, ROTOR]
    return 0.0, p[P.GEAR_RATIO] * x[X.TWIST]


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
def shaft_torque(x, f, brakes, p, acting, dry):  # type: ignore[no-untyped-def]
    """Torque in N m that a state and its forces show on the wheel side; `acting` before the lag.

    `brakes` is the torque at the wheels from outside.
    """
    chain = chain_of(p)
    n = chain.gear_ratio
    speed = relative_speed(x)
    if chain.kind != P.RIGID:
        rate = x[X.HOUSING_SPEED] + speed / n - x[X.WHEEL_SPEED]
        return chain.shaft_stiffness * x[X.TWIST] + chain.shaft_damping * rate + f[SHAFT]
    if chain.torque_lag > 0.0:
        acting = x[X.LAGGED]
    load = f[LOAD] + brakes
    driving = acting - f[LOSS] - chain.viscous_drag * speed - load / n
    if dry:
        direction = speed if abs(speed) > _STANDSTILL_RAD_S else 0.0
        driving -= friction_torque(direction, driving, level(speed, chain, X.NO_MEMORY, p))
    rotor = driving / (chain.motor_inertia + chain.vehicle_inertia / (n * n))
    return chain.vehicle_inertia * rotor / n + load
