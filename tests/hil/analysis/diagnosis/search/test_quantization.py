"""What rounding leaves in errors is bounded by what a step can do."""

import numpy as np

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.search.quantization import rounding_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def test_only_a_rounded_channel_has_rounding() -> None:
    problem = one_problem()
    base = fit(problem, Hypothesis(MODEL), rounds=0)
    assert np.all(rounding_of(problem, [], base) == 0.0)
    step = 4.0
    use = EffectUse("sensor_quantization", {"channel": OUTPUTS[0], "step": step})
    power = rounding_of(problem, [use], base)
    assert 0.0 < power[0] <= (step * problem.weights[0][0]) ** 2 / 12.0
    assert np.all(power[1:] == 0.0)
