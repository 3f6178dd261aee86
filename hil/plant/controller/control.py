"""One control sample of the RMCU: Fig. 3 put together, with the torque limit and its anti-windup.

Before Fig. 3 may stand limits of the request, and in place of its feed-forward (18) a crossing of the play;
both are off where their gains are 0.
"""

from __future__ import annotations

from hil.core.runtime.compiled import compiled
from hil.plant.controller import memory as M
from hil.plant.controller.driving_force import estimate, feedforward, wheel_speed_reference
from hil.plant.controller.filters import settle
from hil.plant.controller.gain_schedule import factor
from hil.plant.controller.play_crossing import cross, expected, lie_on
from hil.plant.controller.request_governor import govern
from hil.plant.controller.wheel_speed_control import motor_torque


@compiled
def enter(b, a, z, k, s, mode, v_hat, w_m, t_m):  # type: ignore[no-untyped-def]
    """Bumpless start of a mode: every filter as if today's speed had always been."""
    s[M.MODE] = mode
    s[M.SLIP] = 0.0
    s[M.INTEGRATOR] = 0.0
    s[M.SATURATED] = 0.0
    s[M.FEEDFORWARD_TORQUE] = 0.0
    s[M.FEEDBACK_TORQUE] = 0.0
    s[M.WHEEL_REFERENCE] = 0.0
    settle(b[M.FEEDFORWARD], a[M.FEEDFORWARD], z[M.FEEDFORWARD], 0.0)
    settle(b[M.SPEED_FILTER], a[M.SPEED_FILTER], z[M.SPEED_FILTER], v_hat / k[M.RADIUS])
    settle(b[M.STABILIZER], a[M.STABILIZER], z[M.STABILIZER], 0.0)
    settle(b[M.OBSERVER_TORQUE], a[M.OBSERVER_TORQUE], z[M.OBSERVER_TORQUE], t_m)
    settle(b[M.OBSERVER_SPEED], a[M.OBSERVER_SPEED], z[M.OBSERVER_SPEED], w_m)
    s[M.REQUEST] = 0.0
    s[M.ROAD_LIMIT] = M.NO_LIMIT
    if k[M.SHAFT_STIFFNESS] > 0.0:
        lie_on(b, a, z, k, s, t_m)


@compiled
def _drive(b, a, z, k, s, request, v_hat, w_m, t_m):  # type: ignore[no-untyped-def]
    """T_m* in N m for rF_d*, before the torque limit."""
    s[M.ESTIMATE] = estimate(b, a, z, t_m, w_m)
    # Anti-windup by conditional integration: while the last torque was clipped, both integrators wait.
    hold = s[M.SATURATED] != 0.0
    reference = govern(k, s, request, v_hat, w_m)
    s[M.FOLLOWED] = reference
    ahead = 0.0
    in_gap = False
    if k[M.SHAFT_STIFFNESS] > 0.0:
        s[M.FEEDFORWARD_TORQUE] = cross(b, a, z, k, s, reference)
        reference = expected(k, s, M.EXPECTED_TORQUE)
        ahead = expected(k, s, M.EXPECTED_SPEED)
        in_gap = reference == 0.0
    else:
        s[M.FEEDFORWARD_TORQUE] = feedforward(b, a, z, reference)
    for_force, for_speed = factor(k, M.DFC_FACTOR, v_hat), factor(k, M.WSC_FACTOR, v_hat)
    if in_gap:
        for_speed *= k[M.PLAY_FACTOR]
    wheel = wheel_speed_reference(k, s, reference, s[M.ESTIMATE], v_hat, hold, for_force)
    s[M.WHEEL_REFERENCE] = wheel
    s[M.FEEDBACK_TORQUE] = motor_torque(b, a, z, k, s, wheel, w_m - ahead, hold, for_speed)
    return s[M.FEEDFORWARD_TORQUE] + s[M.FEEDBACK_TORQUE]


@compiled
def control(b, a, z, k, s, mode, request, v_hat, w_m, t_m):  # type: ignore[no-untyped-def]
    """T_m* in N m. `request`: motor torque in mode torque, rF_d* in mode driving_force."""
    if mode != s[M.MODE]:
        enter(b, a, z, k, s, mode, v_hat, w_m, t_m)
    if mode == M.OFF or mode == M.FAULT:
        s[M.SATURATED] = 0.0
        return 0.0
    limit = k[M.TORQUE_LIMIT]
    torque = request
    if mode == M.DRIVING_FORCE:
        torque = _drive(b, a, z, k, s, request, v_hat, w_m, t_m)
    clipped = min(max(torque, -limit), limit)
    s[M.SATURATED] = 1.0 if clipped != torque else 0.0
    return clipped
