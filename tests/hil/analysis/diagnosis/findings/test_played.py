"""Models played side by side are what the step-by-step kernel says of each."""

import numpy as np
import pytest

from hil.analysis.diagnosis.findings.apart import played
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from hil.plant import Start, gear_ratio_of, simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL

RICHER = (
    MODEL,
    MODEL.with_parameters(shaft_stiffness=1.2 * MODEL.parameters["shaft_stiffness"]),
    MODEL.with_effects(EffectUse("sensor_gain", {"channel": OUTPUTS[1], "gain": 1.05})),
    MODEL.with_effects(EffectUse("dead_time", {"extra_delay_s": 0.004})),
)


@pytest.mark.parametrize("one", range(len(RICHER)))
def test_each_model_is_played_as_if_alone(one: int) -> None:
    torque = np.concatenate([np.zeros(100), np.full(900, 20.0)])
    start = Start(5.0 * (gear_ratio_of(MODEL) or 1.0), 5.0, 0.0, motor_torque_nm=0.0)
    alone = simulate(RICHER[one], torque, 0.001, start)
    together = played(RICHER, torque, 0.001, 5.0)[one]
    for column, channel in enumerate(OUTPUTS):
        size = float(np.max(np.abs(alone[channel])))
        np.testing.assert_allclose(together[:, column], alone[channel], atol=1e-3 * size)
