"""Sensors at rest: offset before a run, drift after it."""

import re

import numpy as np
import pytest

from drivers import Samples, Stream
from hil.core.errors import BenchError
from hil.engine import RunRequest, run_plan
from hil.engine.bench.bench_tables import SensorTable, ZeroLimit
from hil.engine.commissioning.doctor import DoctorRequest, examine_bench
from hil.engine.run.zero import ZeroCheck, turning, zero_of
from tests.benches_for_tests import SIM, plan, sim_bench

PLAN = plan("[{wait: {duration_s: 0.1}}]", end="[]")
LEFT = "shaft_torque_left_nm"
VALUES = Stream("values", "bus 'dyno'", (LEFT, "wheel_speed_left_rad_s"), ("Nm", "rad/s"), 0.001)


def offset(value, **limit):
    simulation = SIM.simulation.model_copy(update={"sensors": {LEFT: SensorTable(offset=value)}})
    return sim_bench(simulation=simulation, zero={LEFT: ZeroLimit(**limit)} if limit else {})


def zeros_of(outcome):
    return {zero.channel: zero for zero in outcome.result.zeros}


def test_an_offset_is_refused_before_anything_is_armed(tmp_path):
    outcome = run_plan(RunRequest(PLAN, offset(20.0, within=5.0), tmp_path))
    assert isinstance(outcome.error, BenchError)
    assert f"{LEFT} reads 20" in outcome.error.what
    assert "the bench file allows 5 N m" in outcome.error.what
    assert outcome.result.safe_state == "not_needed"


def test_without_a_limit_it_is_told_and_nothing_is_refused(tmp_path):
    outcome = run_plan(RunRequest(PLAN, offset(20.0), tmp_path))
    assert outcome.error is None
    left = zeros_of(outcome)[LEFT]
    assert left.before == pytest.approx(20.0, abs=0.3)
    assert left.after == pytest.approx(20.0, abs=0.3)
    assert abs(left.drift) < 0.3
    assert (left.within, left.drift_within, left.unit) == (None, None, "N m")
    assert len(outcome.result.zeros) == 5


def test_the_doctor_finds_it_too():
    found = examine_bench(DoctorRequest(offset(20.0, within=5.0), 0.3))
    (finding,) = found.findings
    assert (finding.severity, finding.where) == ("fault", "zero check")
    assert re.fullmatch(
        rf"{LEFT} reads (20|20\.\d+|19\.\d+) N m at rest, the bench file allows 5 N m", finding.what
    )
    zeros = {zero.channel: zero.before for zero in found.zeros}
    assert zeros["shaft_torque_right_nm"] == pytest.approx(0.0, abs=0.6)
    assert zeros["motor_speed_rad_s"] == pytest.approx(0.0, abs=0.01)


class Loop:
    """Gives readings while it runs."""

    def __init__(self, check, torque, speed=0.0):
        self._check, self._values = check, (torque, speed)

    def run_for(self, duration_s):
        values = np.tile(self._values, (round(duration_s * 1000), 1))
        self._check.take(Samples(VALUES, np.zeros(len(values)), values))


def checked(torque_before, torque_after, speed_after=0.0, *, ended_well=True):
    check = ZeroCheck([VALUES], {LEFT: ZeroLimit(within=5.0, drift=3.0)})
    check.begin()
    Loop(check, torque_before).run_for(0.2)
    check.before()
    check.after(Loop(check, torque_after, speed_after), ended_well=ended_well)  # type: ignore[arg-type]
    return check.zeros[0]


def test_drift_is_the_change():
    zero = checked(1.0, 3.5)
    assert (zero.before, zero.after, zero.drift) == (1.0, 3.5, 2.5)
    with pytest.raises(BenchError, match="has drifted by 4 N m during the run, the bench file allows 3 N m"):
        checked(-1.0, 3.0)


def test_a_reading_just_below_zero_is_no_minus_zero():
    zero = zero_of(LEFT, "N m", None, -1e-9, -1e-9, "")
    assert (str(zero.before), str(zero.after)) == ("0.0", "0.0")


def test_an_axle_that_turns_is_not_read():
    zero = checked(1.0, 30.0, 2.0)
    assert (zero.after, zero.drift_fits) == (None, True)
    assert zero.reason == "the axle turns: wheel_speed_left_rad_s reads 2 rad/s"
    check = ZeroCheck([VALUES], {LEFT: ZeroLimit(within=5.0)})
    check.begin()
    Loop(check, 0.0, 2.0).run_for(0.2)
    with pytest.raises(BenchError, match="cannot be read at rest: the axle turns"):
        check.before()


class Slowing(Loop):
    """Each time that it runs the axle turns by half as fast."""

    def run_for(self, duration_s):
        super().run_for(duration_s)
        torque, speed = self._values
        self._values = torque, 0.5 * speed


def test_an_axle_that_comes_to_rest_within_a_second_is_read():
    check = ZeroCheck([VALUES], {LEFT: ZeroLimit(drift=3.0)})
    check.begin()
    Loop(check, 1.0).run_for(0.2)
    check.before()
    check.after(Slowing(check, 2.0, 4.0), ended_well=True)  # type: ignore[arg-type]
    assert check.zeros[0].drift == 1.0
    check.after(Slowing(check, 2.0, 100.0), ended_well=True)  # type: ignore[arg-type]
    assert check.zeros[0].after is None


def test_after_a_failure_nothing_is_read():
    zero = checked(1.0, 30.0, ended_well=False)
    assert zero.after is None
    assert "the bench failed" in zero.reason


def test_what_is_not_limited_always_fits():
    zero = zero_of("oil_temperature_k", "K", None, 300.0, 310.0, "")
    assert zero.offset_fits
    assert zero.drift_fits
    assert turning({"oil_pressure_pa": 1e5, "wheel_speed_left_rad_s": 0.1}) == ""
    assert (
        turning({"wheel_speed_left_rad_s": -0.6}) == "the axle turns: wheel_speed_left_rad_s reads -0.6 rad/s"
    )
    assert turning({"shaft_torque_left_nm": 0.6}) == ""
