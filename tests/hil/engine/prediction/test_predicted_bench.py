"""A predicted bench takes the ticks that the real devices' drivers take on the simulated wire."""

from __future__ import annotations

import numpy as np
import pytest

from hil.core.model import load_model
from hil.engine.prediction._predicted_bench import PredictedBench
from tests.benches_for_tests import SIM, running


@pytest.fixture
def predicted() -> PredictedBench:
    return PredictedBench(SIM, load_model(SIM.simulation.model))


def test_it_is_armed_at_rest_when_the_recording_begins(predicted: PredictedBench) -> None:
    assert predicted.rmcu.is_safe()
    assert predicted.rmcu.state == "off"
    assert abs(predicted.dyno.wheel_speed_rad_s) < 1e-3
    assert predicted.loop.now_s() > predicted.began * 1e-3
    assert predicted.peaks()["shaft_torque_left_nm"] < 1.0


def test_calls_take_the_ticks_that_they_take_over_can(predicted: PredictedBench) -> None:
    with running("ticks") as bench:
        bench.dyno.enable(SIM.dyno.speed_ramp_m_s2 / SIM.vehicle.wheel_radius_m)
        for call in (
            lambda one: one.dyno.hold_speed(3.0),
            lambda one: one.dyno.release_vehicle(0.0),
            lambda one: one.loop.run_for(0.05),
        ):
            passed = []
            for one, now in ((bench, bench.loop.clock.now_s), (predicted, predicted.loop.now_s)):
                began_s = now()
                call(one)
                passed.append(now() - began_s)
            assert passed[1] == pytest.approx(passed[0], abs=1.5e-3)


def test_waiting_ends_with_its_condition_or_its_time(predicted: PredictedBench) -> None:
    loop = predicted.loop
    began_s = loop.now_s()
    assert loop.wait_for(lambda: loop.now_s() > began_s + 0.0305, 1.0)
    assert loop.now_s() - began_s == pytest.approx(0.031)
    assert not loop.wait_for(lambda: False, 0.02)
    assert loop.now_s() - began_s == pytest.approx(0.051)


def test_torque_turns_the_axle_and_is_switched_off(predicted: PredictedBench) -> None:
    predicted.dyno.release_vehicle(0.0)
    predicted.rmcu.play("motor_torque", np.full(400, 10.0))
    assert predicted.rmcu.state == "torque"
    assert not predicted.rmcu.is_safe()
    assert predicted.peaks()["shaft_torque_left_nm"] > 25.0
    predicted.rmcu.make_safe()
    predicted.loop.run_for(0.1)
    assert predicted.rmcu.is_safe()
