"""A torque that crosses the gears' play at a chosen speed, from a reference model of the shafts.

The reference is the twist φ of the shafts with their gap, -g to g, wheel side. It is driven towards the twist
that belongs to rF_d*, with a limited acceleration a, at a speed that depends on where it is:

    on the flank that is left    min(R_u/k, v_c)
    in the gap                   min(v_c, sqrt(v² + 2 a d))
    on the flank that is met     v = min(R/k, (φ* - φ)/τ)

d is what is left until a margin before the flank: the gears meet at the speed with which the shafts are wound
afterwards. From φ comes T_s = k (φ ∓ g) + c φ' (0 in the gap), from T_s
what wheel and tyre do, and from both the torque that makes the rotor do it:

    T_m* = J_m N (φ'' + ω_l') + T_s/N,    ω_m expected = N (φ' + s) more than the vehicle's

where s is the speed of the wheel over the vehicle's. The wheel speed control is given that speed as part of
its reference, and the driving force control T_s, both late by the dead time of the torque path: feedback acts
on what differs from the plan, not on the plan.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from hil.core.controller.bounds import MOST_DEAD_TIME_SAMPLES
from hil.core.runtime.compiled import compiled
from hil.plant.controller import memory as M
from hil.plant.controller.filters import Filter, settle, step, tustin

_WASHED_OUT = 10.0  # rad/s, below which a speed error is not taken for a twist
_POSITIVE = (
    "play_shaft_stiffness",
    "play_vehicle_inertia",
    "play_crossing_speed",
    "play_crossing_torque",
    "play_follow_gradient",
    "play_follow_time",
    "play_release_gradient",
)
_FIRM = 0.1  # share of k g from which on a torque is believed to lie on a flank


class PlayCrossing:
    """Reference model and limits of the crossing; off without a shaft's stiffness."""

    def __init__(self, parameters: Mapping[str, float]) -> None:
        p = parameters
        self._filters: dict[int, Filter] = {}
        self._gains = dict.fromkeys(range(M.HALF_GAP, M.PLAY_FACTOR + 1), 0.0)
        if p["play_shaft_stiffness"] == 0.0:
            return
        ratio, dt = p["gear_ratio"], p["sample_time"]
        rotor = p["play_motor_inertia"] * ratio
        delay = p["play_dead_time"] / dt
        if (
            min(rotor, *(p[name] for name in _POSITIVE)) <= 0.0
            or p["play_half_gap"] < 0.0
            or not 0.0 <= delay <= MOST_DEAD_TIME_SAMPLES
        ):
            raise ValueError("the reference model of the play is none")
        self._gains |= {
            M.HALF_GAP: p["play_half_gap"],
            M.CROSSING_SPEED: p["play_crossing_speed"],
            M.CROSSING_ACCELERATION: p["play_crossing_torque"] / rotor,
            M.FOLLOW_SPEED: p["play_follow_gradient"] / p["play_shaft_stiffness"],
            M.FOLLOW_TIME: p["play_follow_time"],
            M.RELEASE_SPEED: p["play_release_gradient"] / p["play_shaft_stiffness"],
            M.LANDING_MARGIN: p["play_landing_margin"],
            M.SHAFT_STIFFNESS: p["play_shaft_stiffness"],
            M.SHAFT_DAMPING: p["play_shaft_damping"],
            M.ROTOR_INERTIA: rotor,
            M.DELAY: delay,
            M.CORRECTION: p["play_correction"],
            M.PLAY_FACTOR: p["play_gain_factor"],
        }
        self._filters = _wheel_filters(p)

    def load(self, memory: M.Memory) -> None:
        """Put numbers and filters into the firmware's memory."""
        for index, value in self._gains.items():
            memory.gains[index] = value
        for index, filter_ in self._filters.items():
            memory.place(index, filter_)


def _wheel_filters(p: Mapping[str, float]) -> dict[int, Filter]:
    """ω_l' and the wheel's speed over the vehicle's, of T_s; a wheel without tyre turns with the vehicle."""
    wheel, vehicle, dt = p["wheel_inertia"], p["play_vehicle_inertia"], p["sample_time"]
    stiffness, damping = p["play_tyre_stiffness"], p["play_tyre_damping"]
    if stiffness == 0.0:
        whole = tustin([1.0], [wheel + vehicle], dt)
        return {M.WHEEL_ACCELERATION: whole, M.TYRE_SLIP: tustin([0.0], [1.0], dt)}
    both = wheel + vehicle
    below = [wheel * vehicle, both * damping, both * stiffness]
    return {
        M.WHEEL_ACCELERATION: tustin([vehicle, damping, stiffness], below, dt),
        M.TYRE_SLIP: tustin([vehicle, 0.0], below, dt),
    }


@compiled
def lie_on(b, a, z, k, s, t_m):  # type: ignore[no-untyped-def]
    """Begin with the shafts twisted as a motor torque (N m) twists them, at rest.

    Without torque the flank is not known: the middle is wrong by half of the gap at most.
    """
    torque = t_m * k[M.GEAR_RATIO]
    firm = _FIRM * k[M.SHAFT_STIFFNESS] * k[M.HALF_GAP]
    s[M.FLANK] = min(max(torque / firm, -1.0), 1.0) if firm > 0.0 else 0.0
    s[M.TWIST] = torque / k[M.SHAFT_STIFFNESS] + s[M.FLANK] * k[M.HALF_GAP]
    s[M.TWIST_SPEED] = s[M.SPEED_ERROR] = s[M.SLOW_ERROR] = s[M.AHEAD] = 0.0
    settle(b[M.WHEEL_ACCELERATION], a[M.WHEEL_ACCELERATION], z[M.WHEEL_ACCELERATION], torque)
    settle(b[M.TYRE_SLIP], a[M.TYRE_SLIP], z[M.TYRE_SLIP], torque)
    for i in range(M.RING):
        s[M.EXPECTED_SPEED + i] = 0.0
        s[M.EXPECTED_TORQUE + i] = torque


@compiled
def _wanted_speed(k, x, target):  # type: ignore[no-untyped-def]
    """Speed of the twist at x on its way to a target that lies ahead, rad/s."""
    gap = k[M.HALF_GAP]
    if x >= gap or target <= -gap:
        return min(k[M.FOLLOW_SPEED], (target - x) / k[M.FOLLOW_TIME])
    if x < -gap:
        return min(k[M.RELEASE_SPEED], k[M.CROSSING_SPEED])
    follow = min(k[M.FOLLOW_SPEED], max(0.0, target - gap) / k[M.FOLLOW_TIME])
    left = max(0.0, min(target, gap - k[M.LANDING_MARGIN]) - x)
    return min(k[M.CROSSING_SPEED], math.sqrt(follow * follow + 2.0 * k[M.CROSSING_ACCELERATION] * left))


@compiled
def _look_ahead(k, s):  # type: ignore[no-untyped-def]
    """By how much the axle's twist is ahead of the reference, rad: the integral of what ω_m is faster.

    What lasts is no twist, but a drag or a slope: it is washed out.
    """
    dt = k[M.SAMPLE_TIME]
    faster = -s[M.SPEED_ERROR]
    s[M.SLOW_ERROR] += _WASHED_OUT * dt * (faster - s[M.SLOW_ERROR])
    s[M.AHEAD] += dt * ((faster - s[M.SLOW_ERROR]) / k[M.GEAR_RATIO] - _WASHED_OUT * s[M.AHEAD])


@compiled
def cross(b, a, z, k, s, request):  # type: ignore[no-untyped-def]
    """T_m* that leads the axle along the reference, N m; moves it by one sample."""
    dt, gap = k[M.SAMPLE_TIME], k[M.HALF_GAP]
    if request != 0.0:
        s[M.FLANK] = 1.0 if request > 0.0 else -1.0
    target = s[M.FLANK] * gap + request / k[M.SHAFT_STIFFNESS]
    way = 1.0 if target >= s[M.TWIST] else -1.0
    _look_ahead(k, s)
    passes = gap > 0.0 and way * target > -gap and way * s[M.TWIST] < gap
    ahead = k[M.CORRECTION] * s[M.AHEAD] if passes else 0.0
    if passes and way * (s[M.TWIST] + ahead) >= gap:  # there: the reference goes on from where the axle is
        s[M.TWIST] += ahead
        s[M.AHEAD] -= ahead
        ahead = 0.0
    before = s[M.TWIST_SPEED]
    wanted = way * _wanted_speed(k, way * (s[M.TWIST] + ahead), way * target)
    reach = k[M.CROSSING_ACCELERATION] * dt
    speed = before + min(max(wanted - before, -reach), reach)
    mean = 0.5 * (before + speed)
    half = s[M.TWIST] + ahead + 0.5 * dt * mean
    s[M.TWIST] += dt * mean
    s[M.TWIST_SPEED] = speed
    torque = 0.0
    if half > gap:
        torque = max(0.0, k[M.SHAFT_STIFFNESS] * (half - gap) + k[M.SHAFT_DAMPING] * mean)
    elif half < -gap:
        torque = min(0.0, k[M.SHAFT_STIFFNESS] * (half + gap) + k[M.SHAFT_DAMPING] * mean)
    wheel = step(b[M.WHEEL_ACCELERATION], a[M.WHEEL_ACCELERATION], z[M.WHEEL_ACCELERATION], torque)
    slip = step(b[M.TYRE_SLIP], a[M.TYRE_SLIP], z[M.TYRE_SLIP], torque)
    place = int(s[M.SAMPLES]) % M.RING
    s[M.EXPECTED_SPEED + place] = k[M.GEAR_RATIO] * (before + slip)
    s[M.EXPECTED_TORQUE + place] = torque
    s[M.SAMPLES] += 1.0
    return k[M.ROTOR_INERTIA] * ((speed - before) / dt + wheel) + torque / k[M.GEAR_RATIO]


@compiled
def expected(k, s, first):  # type: ignore[no-untyped-def]
    """Of the ring that begins at state `first`: what the axle shows now, a dead time after it was asked."""
    newest = int(s[M.SAMPLES]) - 1 + M.RING
    whole = math.floor(k[M.DELAY])
    part = k[M.DELAY] - whole
    newer = s[first + (newest - whole) % M.RING]
    return newer + part * (s[first + (newest - whole - 1) % M.RING] - newer)
