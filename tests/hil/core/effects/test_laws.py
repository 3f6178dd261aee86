"""Laws as plain functions, against closed forms."""

import math
from typing import Any, cast

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from hil.core.chain import THREE_INERTIA, TWO_INERTIA, Chain
from hil.core.effects import EFFECTS, Motion
from hil.core.effects.backlash import damping_of

CHAIN = Chain(
    kind=THREE_INERTIA,
    motor_inertia=0.02,
    gear_ratio=8.0,
    shaft_stiffness=6000.0,
    shaft_damping=20.0,
    wheel_inertia=4.0,
    tyre_stiffness=5000.0,
    tyre_damping=300.0,
    vehicle_inertia=300.0,
)
STILL = Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
# What a law leaves alone is None: these have what is asked of them
BACKLASH, COULOMB, LAG, SLIP = (
    cast(Any, EFFECTS[id_].law) for id_ in ("backlash", "coulomb_friction", "dyno_lag", "tyre_slip")
)
small = st.floats(-0.1, 0.1)


@given(twist=small, rate=st.floats(-5, 5), seat=st.sampled_from([-0.02, 0.02]), damping=st.floats(0, 100))
def test_flanks_in_contact_push_and_never_pull(twist, rate, seat, damping):
    motion = STILL._replace(twist=twist, twist_rate=rate)
    linear = CHAIN.shaft_stiffness * twist + CHAIN.shaft_damping * rate
    torque = linear + BACKLASH.shaft(motion, CHAIN, seat, (0.02, damping, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert torque * seat >= -1e-9
    free = CHAIN.shaft_stiffness * (twist - seat) + (CHAIN.shaft_damping + damping) * rate
    assert torque == pytest.approx(max(0.0, free) if seat > 0 else min(0.0, free), abs=1e-9)


@given(twist=small, rate=st.floats(-5, 5), seat=st.floats(-0.0199, 0.0199))
def test_within_the_gap_nothing_is_carried(twist, rate, seat):
    motion = STILL._replace(twist=twist, twist_rate=rate)
    linear = CHAIN.shaft_stiffness * twist + CHAIN.shaft_damping * rate
    assert linear + BACKLASH.shaft(
        motion, CHAIN, seat, (0.02, 10.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    ) == pytest.approx(0.0, abs=1e-9)
    assert BACKLASH.stretch(twist, CHAIN, seat, (0.02, 10.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)) == 0.0


@given(
    twists=st.tuples(small, small),
    rates=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
    seat=st.floats(-0.02, 0.02) | st.sampled_from([-0.02, 0.02]),
    depth=st.sampled_from([0.0, 5e-4]),
    tension=st.sampled_from([0.0, 1.0]),
)
def test_nothing_leaps_where_the_seat_stays(twists, rates, seat, depth, tension):
    """Kernels do not ask for a leap then."""
    values = BACKLASH.prepare(CHAIN, (0.02, 30.0, 1.0, 0.0, tension, depth, 0.0, 0.0))
    before, after = (
        STILL._replace(twist=twist, twist_rate=rate) for twist, rate in zip(twists, rates, strict=True)
    )
    given = before, after, CHAIN, seat, values, 1e-3
    assert BACKLASH.remember(*given) != seat or BACKLASH.leap(*given) == (0.0, 0.0)


@pytest.mark.parametrize("restitution", [0.1, 0.2, 0.5, 0.9])
def test_a_blow_gives_back_the_share_of_speed_that_restitution_says(restitution):
    """A mass on a damped spring that lets go once it would pull, by an integrator of others."""
    damping = damping_of(restitution, CHAIN)
    rotor = CHAIN.motor_inertia * CHAIN.gear_ratio**2
    mass = rotor * CHAIN.wheel_inertia / (rotor + CHAIN.wheel_inertia)

    def force(t, x):
        return CHAIN.shaft_stiffness * x[0] + damping * x[1]

    force.terminal, force.direction = True, -1  # type: ignore[attr-defined]
    blow = solve_ivp(
        lambda t, x: [x[1], -force(t, x) / mass], (0, 1), [0.0, 1.0], events=force, rtol=1e-9, atol=1e-12
    )
    assert -blow.y[1, -1] == pytest.approx(restitution, rel=1e-5)


def test_what_gives_back_next_to_nothing_acts_as_a_tenth():
    assert damping_of(0.0, CHAIN) == damping_of(0.1, CHAIN) < math.inf


def test_an_elastic_blow_has_no_damping_of_its_own():
    elastic = (0.02, 7.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert BACKLASH.prepare(CHAIN, elastic) == elastic
    two = CHAIN._replace(kind=TWO_INERTIA)
    half = (0.02, 7.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert BACKLASH.prepare(two, half)[1] > BACKLASH.prepare(CHAIN, half)[1] > 7.0


def contact(twist: float, rate: float, seat: float, **others: float) -> float:
    """Torque in N m of shafts with a half gap of 0.02 rad."""
    law = dict.fromkeys((p.name for p in EFFECTS["backlash"].parameters[1:]), 0.0) | {"restitution": 1.0}
    motion = STILL._replace(twist=twist, twist_rate=rate)
    linear = CHAIN.shaft_stiffness * twist + CHAIN.shaft_damping * rate
    values = BACKLASH.prepare(CHAIN, (0.02, *(law | others).values()))
    return linear + float(BACKLASH.shaft(motion, CHAIN, seat, values))


@given(
    depth=st.floats(0.0, 0.1), rate=st.floats(-5, 5), damping=st.floats(0, 100), side=st.sampled_from([-1, 1])
)
def test_flanks_under_tension_are_kelvins_and_voigts_spring_and_damper(depth, rate, damping, side):
    got = contact(
        side * (0.02 + depth), side * rate, side * 0.02, contact_damping_nms_rad=damping, tension=1.0
    )
    assert side * got == pytest.approx(6000.0 * depth + (20.0 + damping) * rate, abs=1e-9)


@given(
    depth=st.floats(0.0, 0.1), rate=st.floats(-5, 5), factor=st.floats(0, 500), side=st.sampled_from([-1, 1])
)
def test_flanks_that_are_damped_by_their_depth_are_hunts_and_crossleys(depth, rate, factor, side):
    got = contact(side * (0.02 + depth), side * rate, side * 0.02, depth_damping_nms_rad2=factor, tension=1.0)
    pushing = max(0.0, 6000.0 * depth + factor * depth * rate)
    assert side * got == pytest.approx(pushing + 20.0 * rate, abs=1e-9)
    alone = contact(side * (0.02 + depth), side * rate, side * 0.02, depth_damping_nms_rad2=factor)
    assert side * alone == pytest.approx(max(0.0, (6000.0 + factor * rate) * depth + 20.0 * rate), abs=1e-9)


@given(
    depth=st.floats(-0.05, 0.1),
    rate=st.floats(-5, 5),
    damping=st.floats(0, 100),
    span=st.floats(1e-5, 0.05),
    side=st.sampled_from([-1, 1]),
)
def test_damping_sets_in_over_the_depth_beyond_where_untwisted_shafts_meet(depth, rate, damping, span, side):
    """A seat at the flank, the twist anywhere: shafts may still be wound the other way."""
    law = {"contact_damping_nms_rad": damping, "contact_depth_rad": span}
    share = min(max(depth / span, 0.0), 1.0)
    step = 3.0 * share**2 - 2.0 * share**3
    got = contact(side * (0.02 + depth), side * rate, side * 0.02, **law)
    assert side * got == pytest.approx(max(0.0, 6000.0 * depth + (20.0 + damping * step) * rate), abs=1e-9)
    whole = contact(side * (0.02 + depth), side * rate, side * 0.02, **law, one_spring=1.0)
    assert side * whole == pytest.approx(max(0.0, 6000.0 * depth + (20.0 + damping) * step * rate), abs=1e-9)


@given(twist=small)
def test_one_spring_is_untwisted_at_once_when_it_is_free(twist):
    motion = STILL._replace(twist=twist)
    values = BACKLASH.prepare(CHAIN, (0.02, 5.0, 1.0, 0.0, 0.0, 1e-3, 1.0, 0.0))
    seat = BACKLASH.remember(STILL, motion, CHAIN, 0.01, values, 1e-4)
    assert seat == min(max(twist, -0.02), 0.02)


@given(twist=small)
def test_shafts_under_tension_are_in_contact_where_their_twist_is_beyond_the_gap(twist):
    motion = STILL._replace(twist=twist)
    seat = BACKLASH.remember(STILL, motion, CHAIN, 0.01, (0.02, 5.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0), 1e-4)
    assert seat == min(max(twist, -0.02), 0.02)


@given(angle=st.floats(1e-4, 1.0), turn=st.floats(1e-3, 1.0))
def test_friction_turns_around_over_its_angle(angle, turn):
    """Dahl's closed form after a reversal: F = T_c·(1 - 2·exp(-θ/θ_t))."""
    values = (2.0, 0.0, 0.0, turn, 2.0, 2.0, 0.0)
    h = 1e-3
    moving = STILL._replace(rotor_speed=angle / h)
    bent = COULOMB.remember(moving, moving, CHAIN, -1.0, values, h)
    assert COULOMB.loss(moving, CHAIN, bent, values) == pytest.approx(2.0 * (1 - 2 * math.exp(-angle / turn)))
    assert COULOMB.dry(moving, CHAIN, bent, values) == 0.0


def test_friction_that_turns_at_once_sticks_and_keeps_nothing():
    values = (2.0, 0.5, 0.3, 0.0, 2.0, 2.0, 0.0)
    assert COULOMB.dry(STILL, CHAIN, 0.0, values) == 2.5
    assert COULOMB.loss(STILL, CHAIN, 0.7, values) == 0.3
    assert COULOMB.remember(STILL, STILL, CHAIN, 0.7, values, 1e-3) == 0.0


@pytest.mark.parametrize("power", [0.7, 1.0, 2.0])
def test_the_peak_at_rest_falls_with_a_power_of_the_speed(power):
    values = (2.0, 0.5, 0.0, 0.0, 4.0, power, 0.0)
    for speed in (0.0, 0.3, 4.0, 9.0):
        told = 2.0 + 0.5 * math.exp(-((speed / 4.0) ** power))
        for way in (-1.0, 1.0):
            level = COULOMB.dry(STILL._replace(rotor_speed=way * speed), CHAIN, 0.0, values)
            assert level == pytest.approx(told)


@pytest.mark.parametrize("speed", [-6.0, -0.5, 0.2, 3.0])
def test_damped_bristles_are_lugres(speed):
    """dz/dt = v - s0·|v|·z/g(v), F = s0·z + s1·dz/dt, at a constant speed by an integrator of others."""
    torque, stribeck, turn, width, damping = 2.0, 0.8, 0.05, 1.5, 0.3
    stiffness = torque / turn
    level = torque + stribeck * math.exp(-((speed / width) ** 2))

    def rate(bristle: float) -> float:
        return speed - stiffness * abs(speed) * bristle / level

    bent_for_s = 0.02
    lugre = solve_ivp(lambda t, z: [rate(z[0])], (0, bent_for_s), [-0.01], rtol=1e-10, atol=1e-13)
    told = stiffness * lugre.y[0, -1] + damping * rate(lugre.y[0, -1])
    values = (torque, stribeck, 0.1, turn, width, 2.0, damping)
    moving = STILL._replace(rotor_speed=speed)
    bent = COULOMB.remember(moving, moving, CHAIN, -0.01 * stiffness / torque, values, bent_for_s)
    assert COULOMB.loss(moving, CHAIN, bent, values) == pytest.approx(told + 0.1, rel=1e-7)


@given(st.floats(1e-3, 1.0), st.floats(-50, 50))
def test_a_late_dynamometer_follows_a_ramp_by_its_time_constant(tau, slope):
    behind, h = 0.0, 1e-3
    for k in range(3000):
        before, after = (STILL._replace(vehicle_speed=slope * h * (k + i)) for i in (0, 1))
        behind = LAG.remember(before, after, CHAIN, behind, (tau,), h)
    assert behind == pytest.approx(slope * tau * (1 - math.exp(-3.0 / tau)), abs=1e-9)


def test_a_slipping_tyre_is_a_spring_at_rest_and_relaxes_by_the_way_it_rolls():
    chain = CHAIN._asdict()
    SLIP.chain(chain, {"slip_stiffness_nm": 8000.0, "relaxation_length_m": 0.4})
    assert chain["tyre_stiffness"] == pytest.approx(8000.0 * 0.33 / 0.4)
    twisted = STILL._replace(tyre_twist=0.1)
    assert SLIP.tyre_rate(twisted, CHAIN, 0.0, (8000.0, 0.4)) == 0.0
    rolling = twisted._replace(vehicle_speed=-10.0)
    assert SLIP.tyre_rate(rolling, CHAIN, 0.0, (8000.0, 0.4)) == pytest.approx(-10.0 * 0.33 / 0.4 * 0.1)
