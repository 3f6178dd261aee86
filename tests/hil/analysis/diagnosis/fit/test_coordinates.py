"""Free numbers and where they enter the plant."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis, key_of, sensors_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from hil.plant import SENSOR_DELAY, SENSOR_GAIN, SENSOR_OFFSET
from tests.hil.analysis.diagnosis.one_recording import MODEL

GAIN = EffectUse("sensor_gain", {"channel": OUTPUTS[1], "gain": 1.1})
LATE = EffectUse("channel_skew", {"channel": OUTPUTS[1], "delay_s": 0.003})
LAG = EffectUse("actuator_lag", {"time_constant_s": 0.01})


def test_the_start_stands_for_the_model_itself() -> None:
    hypothesis = Hypothesis(MODEL, (LAG,))
    found = hypothesis.model(hypothesis.start())
    assert found.parameters == pytest.approx(MODEL.parameters)
    assert found.effects[0].values["time_constant_s"] == pytest.approx(0.01)


def test_base_parameters_move_on_a_logarithmic_scale() -> None:
    hypothesis = Hypothesis(MODEL)
    theta = hypothesis.start()
    index = [c.name for c in hypothesis.coordinates()].index("shaft_stiffness")
    theta[index] = np.log(1.02)
    assert hypothesis.model(theta).parameters["shaft_stiffness"] == pytest.approx(
        1.02 * MODEL.parameters["shaft_stiffness"]
    )


def test_a_wrong_parameter_may_go_further() -> None:
    wrong = EffectUse("parameter_mismatch", {"parameter": "vehicle_inertia", "value": 400.0})
    hypothesis = Hypothesis(MODEL, (wrong,))
    free = {c.name: c for c in hypothesis.coordinates()}
    assert free["vehicle_inertia"].upper > 1.0 > free["motor_inertia"].upper
    assert np.isinf(free["vehicle_inertia"].prior)
    assert hypothesis.model(hypothesis.start()).parameters["vehicle_inertia"] == pytest.approx(400.0)


def test_terms_are_added_and_taken_away() -> None:
    two = Hypothesis(MODEL, (LAG,)).with_term(GAIN)
    assert two.ids == ("actuator_lag", "sensor_gain")
    assert two.without(0).keys == (key_of(GAIN),) == (("sensor_gain", OUTPUTS[1]),)


def test_dead_time_takes_the_place_of_the_models_own() -> None:
    late = Hypothesis(MODEL, (EffectUse("dead_time", {"extra_delay_s": 0.001}),))
    assert "torque_delay" not in [c.name for c in late.coordinates()]


def test_sensor_effects_of_a_channel_come_together() -> None:
    sensors = sensors_of(MODEL.with_effects(GAIN, GAIN, LATE))
    assert sensors[1, SENSOR_GAIN] == pytest.approx(1.21)
    assert sensors[1, SENSOR_DELAY] == pytest.approx(0.003)
    assert sensors[0, SENSOR_GAIN] == 1.0
    assert np.all(sensors[:, SENSOR_OFFSET] == 0.0)
