"""The closed loop in memory, many milliseconds a call; against the wire it is held in tests/hil/engine."""

import dataclasses

import numpy as np
import pytest

from drivers.rmcu._parameters import parameters_of
from hil.core.controller import load_controller
from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.engine.prediction._predicted_wire import wire_of
from hil.plant.closed_loop import SIDES, ClosedLoop
from hil.plant.closed_loop import drive as D
from hil.plant.controller import memory as M
from tests.benches_for_tests import SIM

MODEL = load_model(SIM.simulation.model)
WIRE = wire_of(SIM).rounding
LIBRARY = SIM.source.parent.parent / "test_plans/library/controllers"
PHASE = parameters_of(load_controller(LIBRARY / "phase_stabilization.toml"))
RADIUS_M = 0.33


@pytest.fixture
def loop():
    found = ClosedLoop(MODEL, RADIUS_M, WIRE)
    found.set_ramp(12.0)
    return found


def hold(loop, speed_rad_s, samples):
    for side in SIDES:
        loop.drive_mode(side, D.SPEED)
        loop.target_speed(side, speed_rad_s)
    loop.run(samples)


def release(loop, speed_rad_s):
    loop.plant.set_vehicle(initial_speed_m_s=speed_rad_s * RADIUS_M)
    for side in SIDES:
        loop.drive_mode(side, D.VEHICLE)


def test_in_pieces_as_at_once(loop):
    request = 100.0 * np.sin(0.05 * np.arange(3000))
    pieces = ClosedLoop(MODEL, RADIUS_M, WIRE)
    pieces.set_ramp(12.0)
    for each in (loop, pieces):
        each.set_controller(PHASE)
        hold(each, 3.0, 500)
        release(each, 3.0)
    loop.play(M.DRIVING_FORCE, request)
    for part in np.split(request, [1, 10, 11, 2048]):
        pieces.play(M.DRIVING_FORCE, part)
    assert np.ptp(loop.recorded(500, 3500)["motor_speed_rad_s"]) > 1.0
    np.testing.assert_array_equal(loop.rows, pieces.rows)


def test_what_was_recorded_stays_when_there_is_more(loop):
    hold(loop, 3.0, 1000)
    before = loop.recorded(0, 1000)
    loop.run(40_000)
    assert len(loop.rows) == loop.samples == 41_000
    for name, values in loop.recorded(0, 1000).items():
        np.testing.assert_array_equal(values, before[name])


def test_drives_ramp_to_a_speed_and_hold_it(loop):
    hold(loop, 6.0, 3000)
    speed = loop.recorded(0, 3000)["wheel_speed_rad_s"]
    assert speed[250] == pytest.approx(12.0 * 0.25, abs=1.5)  # on its way, behind by the loop's lag
    assert np.max(np.abs(speed[2000:] - 6.0)) < 0.1


def test_a_released_vehicle_gains_speed_by_its_torque(loop):
    release(loop, 0.0)
    loop.play(M.TORQUE, np.full(2000, 20.0))
    channels = loop.recorded(0, 2000)
    gained = 20.0 * 8.148 / (303.0 + 4.355 + 0.02 * 8.148**2) * 1.9
    assert channels["wheel_speed_rad_s"][1950] == pytest.approx(gained, rel=0.1)
    assert np.all(channels["motor_torque_ref_nm"] == 20.0)
    loop.off()
    loop.run(1)
    assert loop.recorded(2000, 2001)["motor_torque_ref_nm"][0] == 0.0


def test_numbers_are_rounded_as_frames_round_them(loop):
    loop.play(M.TORQUE, np.full(3, 1.23456))
    channels = loop.recorded(0, 3)
    assert set(np.round(channels["motor_torque_ref_nm"], 9)) == {1.24}  # 1.235 as it was requested
    counts = channels["motor_speed_rad_s"] / WIRE.channels["motor_speed_rad_s"].scale
    np.testing.assert_allclose(counts, np.rint(counts), atol=1e-6)
    np.testing.assert_array_equal(channels["time_s"], [0.0, 0.001, 0.002])


def test_a_frame_nearer_to_another_sample_is_taken_for_it(loop):
    late = dataclasses.replace(WIRE, late={"motor_torque_nm": -1})
    loop.play(M.TORQUE, np.arange(30.0))
    here, shifted = loop.recorded(0, 30), late.recorded(loop.rows, 0.001)
    np.testing.assert_array_equal(shifted["motor_torque_nm"][1:], here["motor_torque_nm"][:-1])
    np.testing.assert_array_equal(shifted["motor_torque_ref_nm"], here["motor_torque_ref_nm"])


def test_parameters_cross_the_wire_as_singles(loop):
    loop.set_controller(PHASE)
    assert loop._memory.gains[M.K_P] == np.float32(PHASE["k_p"])
    assert loop._memory.gains[M.K_P] != PHASE["k_p"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"torque_limit": 301.0}, "'torque_limit' = 301: out_of_range"),
        ({"sigma": 0.0}, "parameters: out_of_range"),
        ({"k_p": float("nan")}, "'k_p' = nan: out_of_range"),
    ],
)
def test_what_the_rmcu_would_refuse_is_refused(loop, change, said):
    with pytest.raises(BenchError, match=said):
        loop.set_controller({**PHASE, **change})


def test_parameters_that_are_missing_are_refused(loop):
    with pytest.raises(BenchError, match="incomplete"):
        loop.set_controller({name: value for name, value in PHASE.items() if name != "k_i"})


def test_a_model_without_a_shaft_is_refused():
    functions = load_model(SIM.source.parent / "paper_functions.toml")
    with pytest.raises(BadInputError, match="no shaft to load"):
        ClosedLoop(functions, RADIUS_M, WIRE)
