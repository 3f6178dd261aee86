"""The crossing of the play: its reference against closed forms, and an axle that follows it unaided."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.play_crossing import CROSSING
from drivers import parameters_of
from hil.core.controller import Controller, load_controller
from hil.core.model import EffectUse, Model
from hil.fmu import Axle
from hil.plant.closed_loop import tick as T
from hil.plant.controller import Memory, build
from hil.plant.controller import memory as M
from hil.plant.controller.play_crossing import cross, expected
from tests.hil.plant.test_effects import THREE

SHIPPED = load_controller(CROSSING)
PLAY = SHIPPED.play
assert PLAY is not None
GAP, K, C = PLAY.half_gap_rad, PLAY.shaft_stiffness_nm_rad, PLAY.shaft_damping_nms_rad
DT = SHIPPED.sample_time_s
GEAR = SHIPPED.dfo.gear_ratio
Array = np.ndarray


def with_play(controller: Controller = SHIPPED, **values: float | None) -> Controller:
    assert PLAY is not None
    return controller.model_copy(update={"play": PLAY.model_copy(update=values)})


def without_feedback(controller: Controller) -> Controller:
    wsc = controller.wsc.model_copy(update={"proportional_gain": 0.0, "integral_gain": 0.0})
    dfc = controller.dfc.model_copy(update={"integral_gain": 0.0})
    return controller.model_copy(update={"wsc": wsc, "dfc": dfc})


def reference(controller: Controller, requests: Array) -> tuple[Array, Array, Array]:
    """Twist (rad), its speed (rad/s), T_s (N m) of the reference; it begins in the middle of the gap."""
    memory = Memory()
    assert build(parameters_of(controller), memory) == 0
    arrays = (memory.numerators, memory.denominators, memory.filter_states, memory.gains, memory.states)
    rows = []
    for request in requests:
        cross(*arrays, request)
        s = memory.states
        torque = s[M.EXPECTED_TORQUE + (int(s[M.SAMPLES]) - 1) % M.RING]
        rows.append((s[M.TWIST], s[M.TWIST_SPEED], torque))
    return tuple(np.array(rows).T)  # type: ignore[return-value]


STEP = np.repeat([-150.0, 300.0], [600, 400])


def test_the_reference_rests_on_the_twist_of_the_request() -> None:
    twist, speed, torque = reference(SHIPPED, STEP)
    assert torque[599] == pytest.approx(-150.0, abs=0.01)
    assert twist[599] == pytest.approx(-GAP - 150.0 / K, abs=1e-6)
    assert torque[-1] == pytest.approx(300.0, abs=0.01)
    assert speed[-1] == pytest.approx(0.0, abs=1e-4)


def test_the_gap_takes_as_long_as_its_trapezium() -> None:
    """Enters at v_c, brakes to v at the margin before the flank, goes on at v."""
    assert PLAY is not None
    twist, speed, _ = reference(SHIPPED, STEP)
    inside = np.abs(twist[600:]) < GAP
    v, a = PLAY.follow_gradient_nm_s / K, PLAY.crossing_torque_nm / (PLAY.motor_inertia_kg_m2 * GEAR)
    fast = min(PLAY.crossing_speed_rad_s, PLAY.release_gradient_nm_s / K)
    braking = (fast**2 - v**2) / (2 * a)
    margin = PLAY.landing_margin_rad
    takes_s = (2 * GAP - margin - braking) / fast + (fast - v) / a + margin / v
    assert np.sum(inside) * DT == pytest.approx(takes_s, abs=2.5e-3)
    assert speed[600:][inside].max() <= PLAY.crossing_speed_rad_s + 1e-9
    landing = speed[600:][np.flatnonzero(inside)[-1]]
    assert landing == pytest.approx(v, abs=0.05)


def test_torque_grows_no_faster_than_its_gradient_where_the_flanks_touch() -> None:
    assert PLAY is not None
    twist, _, torque = reference(SHIPPED, STEP)
    met = 600 + int(np.flatnonzero(twist[600:] > GAP)[0]) + 2  # the jump of the damping is over
    assert np.diff(torque[met:]).max() <= 1.02 * PLAY.follow_gradient_nm_s * DT
    left = slice(600, 600 + int(np.flatnonzero(twist[600:] > -GAP)[0]))
    assert np.diff(torque[left]).max() <= 1.02 * PLAY.release_gradient_nm_s * DT + C * 0.4


def test_what_is_expected_comes_a_dead_time_later() -> None:
    controller = with_play(dead_time_s=0.0035)
    memory = Memory()
    build(parameters_of(controller), memory)
    arrays = (memory.numerators, memory.denominators, memory.filter_states, memory.gains, memory.states)
    shown, asked = [], []
    for request in STEP:
        cross(*arrays, request)
        newest = (int(memory.states[M.SAMPLES]) - 1) % M.RING
        asked.append(memory.states[M.EXPECTED_TORQUE + newest])
        shown.append(expected(memory.gains, memory.states, M.EXPECTED_TORQUE))
    late = 0.5 * (np.array(asked[1:-3]) + np.array(asked[:-4]))  # between three and four samples
    assert np.array(shown[4:]) == pytest.approx(late, abs=1e-9)


def axle_of(controller: Controller, half_gap_rad: float) -> Axle:
    gap = (EffectUse("backlash", {"half_gap_rad": half_gap_rad}),) if half_gap_rad else ()
    model = Model("three_inertia", THREE.parameters | {"torque_delay": 0.008}, gap)
    return Axle(model, controller, initial_speed_m_s=30 / 3.6)


def test_an_axle_follows_the_reference_without_feedback() -> None:
    """The torque is that of the reference: nothing else leads the axle, and it lands as slowly."""
    assert PLAY is not None
    asked = np.repeat([300.0, -150.0, 300.0], [600, 600, 600])
    found = axle_of(without_feedback(SHIPPED), GAP).play(asked)["shaft_torque_nm"]
    _, _, wanted = reference(SHIPPED, asked)
    late = found[608:] - wanted[600:-8]
    assert np.abs(late).max() < 30.0  # N m, where flanks meet a millisecond apart
    assert np.sqrt(np.mean(late**2)) < 5.0
    met = np.flatnonzero(found[1200:] > 5.0)[0] + 1200
    blow = np.max(found[met + 4 : met + 50] - found[met : met + 46]) / (4 * DT)
    jump = C * PLAY.follow_gradient_nm_s / K / (4 * DT)
    assert blow < 1.15 * (PLAY.follow_gradient_nm_s + jump)


@pytest.mark.parametrize("half_gap_rad", [0.0, GAP])
def test_feedback_has_nothing_to_do_where_the_model_is_right(half_gap_rad: float) -> None:
    controller = with_play(half_gap_rad=half_gap_rad)
    axle = axle_of(controller, half_gap_rad)
    axle.play(np.repeat([300.0, -150.0, 300.0], [600, 600, 300]))
    torque = axle._loop.rows[-900:, T.FEEDBACK_TORQUE]
    assert np.abs(torque).max() < 6.0  # N m, of 37 that are asked for


def test_a_request_of_nothing_keeps_the_flank() -> None:
    twist, _, torque = reference(SHIPPED, np.repeat([-150.0, 0.0], [600, 400]))
    assert twist[-1] == pytest.approx(-GAP, abs=1e-5)
    assert torque[-1] == pytest.approx(0.0, abs=0.05)


def test_a_launch_begins_in_the_middle_of_the_gap() -> None:
    twist, _, torque = reference(SHIPPED, np.full(300, 300.0))
    assert 0.0 < twist[0] < 1e-3
    assert torque[-1] == pytest.approx(300.0, rel=1e-3)


def test_without_a_tyre_the_wheel_turns_with_the_vehicle() -> None:
    assert PLAY is not None
    controller = with_play(tyre_stiffness_nm_rad=None)
    memory = Memory()
    assert build(parameters_of(controller), memory) == 0
    whole = 1.0 / (SHIPPED.dfo.wheel_inertia_kg_m2 + PLAY.vehicle_inertia_kg_m2)
    assert memory.numerators[M.WHEEL_ACCELERATION, 0] == pytest.approx(whole)
    assert not memory.numerators[M.TYRE_SLIP].any()
    assert math.isclose(memory.gains[M.ROTOR_INERTIA], PLAY.motor_inertia_kg_m2 * GEAR)


def test_parameters_that_are_no_reference_are_refused() -> None:
    good = parameters_of(SHIPPED)
    for name, value in (
        ("play_dead_time", 0.065),
        ("play_dead_time", -1e-3),
        ("play_follow_time", 0.0),
        ("play_motor_inertia", 0.0),
        ("play_shaft_stiffness", -1.0),
        ("play_crossing_torque", 0.0),
        ("play_release_gradient", 0.0),
        ("play_vehicle_inertia", 0.0),
        ("play_half_gap", -0.01),
    ):
        assert build({**good, name: value}, Memory()) == 2, name  # OUT_OF_RANGE
