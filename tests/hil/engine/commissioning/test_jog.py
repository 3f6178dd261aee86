"""The axle is turned, and a sensor or a command with the wrong sign is found."""

import numpy as np
import pytest

from hil.core.errors import BadInputError, BenchError, InterruptError
from hil.core.recording import Recording
from hil.core.result import Segment
from hil.engine.bench.bench_tables import SensorTable
from hil.engine.commissioning.jog import JogRequest, jog, jog_bench, jog_plan, signs_of
from tests.benches_for_tests import SIM, sim_bench
from tests.operators import Answering

SPEEDS = ("motor_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s")
SHAFTS = ("shaft_torque_left_nm", "shaft_torque_right_nm")
OTHERS = ("motor_torque_ref_nm", "motor_torque_nm", "vehicle_speed_m_s")
DRIVEN = Segment(id="driven", start_s=0.0, step_s=0.5, end_s=3.5)
TURNED = Segment(id="turned", start_s=4.0, step_s=4.5, end_s=5.5)


def jogged(tmp_path, **sensors):
    tables = {name: SensorTable(**values) for name, values in sensors.items()}
    simulation = SIM.simulation.model_copy(update={"sensors": tables})
    return jog(JogRequest(sim_bench(simulation=simulation), tmp_path))


def test_a_bench_whose_signs_are_right(tmp_path):
    outcome = jogged(tmp_path)
    assert outcome.run.error is None
    assert outcome.run.result.safe_state == "confirmed"
    assert outcome.signs.right
    assert outcome.signs.findings == ()
    assert len(outcome.signs.signs) == 11
    change = {(sign.test, sign.channel): sign.change for sign in outcome.signs.signs}
    assert change["motor torque", "shaft_torque_left_nm"] == pytest.approx(40.0, abs=3.0)  # half the gear
    assert change["dynos forwards", "wheel_speed_left_rad_s"] == pytest.approx(0.42, abs=0.02)


def test_a_sensor_with_the_wrong_sign_is_found_with_its_place(tmp_path):
    outcome = jogged(tmp_path, shaft_torque_left_nm={"gain": -1.0}, wheel_speed_right_rad_s={"gain": -1.0})
    assert outcome.run.result.safe_state == "confirmed"
    assert not outcome.signs.right
    shaft, wheel = outcome.signs.findings
    assert shaft.what.startswith("shaft_torque_left_nm has the wrong sign: it changed by -4")
    assert shaft.where.endswith("(dyno.eds): 'Shaft torque' of node 3")
    assert f"{SIM.source}, line 22" in shaft.where
    assert SIM.text.splitlines()[21].startswith("eds")
    assert "wheel_speed_right_rad_s has the wrong sign" in wheel.what
    assert "dynos forwards" in wheel.what


def recorded(driven, turned=None, **changed):
    """Channels that go from 0 to `driven` and then to `turned`; `changed` ones by a factor of that."""
    time_s = np.arange(0.0, 5.5, 0.01)
    channels = {"time_s": time_s}
    for name in (*SPEEDS, *SHAFTS, *OTHERS):
        values = np.where(time_s < 0.5, 0.0, driven)
        values = np.where(time_s > 3.6, turned or 0.0, values)
        channels[name] = values * changed.get(name, 1.0)
    segments = [DRIVEN] if turned is None else [DRIVEN, TURNED]
    return signs_of(Recording(channels, SIM.source), segments, SIM)


def test_a_torque_request_with_the_wrong_sign_is_told_once():
    found = recorded(-5.0, 5.0, motor_torque_ref_nm=-1.0, motor_torque_nm=-1.0, vehicle_speed_m_s=-1.0)
    (finding,) = found.findings
    assert finding.what == "motor torque: every sensor says that the axle turned backwards"
    assert "the RMCU's torque request" in finding.fix
    assert finding.where.endswith("(rmcu.dbc)")


def test_dynos_that_turn_backwards_are_told_once():
    (finding,) = recorded(5.0, -5.0).findings
    assert finding.what == "dynos forwards: every sensor says that the axle turned backwards"
    assert finding.where.endswith("(dyno.eds)")


def test_a_sensor_that_does_not_move_is_not_right():
    found = recorded(5.0, 5.0, shaft_torque_right_nm=0.0)
    (finding,) = found.findings
    assert finding.what == "shaft_torque_right_nm did not move (motor torque)"
    assert not found.right


def test_a_jog_that_was_cut_off_tells_what_it_saw():
    found = recorded(5.0, motor_speed_rad_s=-1.0)
    assert {sign.test for sign in found.signs} == {"motor torque"}
    (finding,) = found.findings
    assert finding.where.endswith("(rmcu.dbc): signal 'MotorSpeed' of 'RMCU_Status'")
    assert not signs_of(Recording({"time_s": np.zeros(0)}, SIM.source), [], SIM).right


def test_the_limits_are_those_of_a_jog():
    limits = jog_bench(SIM, 10.0).limits
    assert (limits.motor_torque_nm, limits.wheel_speed_rad_s) == (15.0, 10.0)
    tight = SIM.model_copy(update={"limits": SIM.limits.model_copy(update={"wheel_speed_rad_s": 2.0})})
    assert jog_bench(tight, 10.0).limits.wheel_speed_rad_s == 2.0


def test_what_runs_away_is_stopped_and_left_safe(tmp_path):
    near = SIM.limits.model_copy(update={"motor_speed_rad_s": 2.0})
    outcome = jog(JogRequest(sim_bench(limits=near), tmp_path))
    assert isinstance(outcome.run.error, BenchError)
    assert "limit tripped: motor_speed_rad_s" in outcome.run.error.what
    assert outcome.run.result.safe_state == "confirmed"


@pytest.mark.parametrize("torque_nm", [0.0, -5.0, 200.0, float("nan")])
def test_a_torque_that_is_no_jogging_is_refused(torque_nm):
    with pytest.raises(BadInputError, match="--torque"):
        jog_plan(torque_nm, SIM)


def test_the_operator_is_asked_before_the_axle_turns_and_whether_it_did(tmp_path):
    operator = Answering()
    outcome = jog(JogRequest(sim_bench("asking"), tmp_path, terminal=operator))
    assert outcome.signs.right
    assert [text.split()[0] for text in operator.told] == ["The", "Did", "Did"]
    declines = Answering("q")
    outcome = jog(JogRequest(sim_bench("declining"), tmp_path / "again", terminal=declines))
    assert isinstance(outcome.run.error, InterruptError)
    assert outcome.run.result.segments == ()
    assert len(declines.told) == 1


def test_on_hardware_somebody_is_asked(tmp_path):
    with pytest.raises(BadInputError, match="there is no terminal to ask on"):
        jog(JogRequest(sim_bench(simulation=None), tmp_path))
