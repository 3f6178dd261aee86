"""What a fit leaves, and how firmly one is preferred."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.search.evidence import Evidence, colour, split_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, left, one_problem

GAIN = EffectUse("sensor_gain", {"channel": OUTPUTS[2], "gain": 1.2})


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    problem = one_problem(GAIN, seconds=8.0)
    return Evidence(problem, fit(problem, Hypothesis(MODEL), rounds=0))


def test_the_true_effect_closes_the_gap(evidence: Evidence) -> None:
    true = fit(evidence.problem, Hypothesis(MODEL, (GAIN,)), rounds=1)
    assert not evidence.closed(evidence.base)
    assert evidence.closed(true)
    assert evidence.settled(true)
    assert evidence.share(true) > 0.95
    assert evidence.share(evidence.base) == 0.0
    assert evidence.worst(true) < 1.1 < evidence.worst(evidence.base)
    assert evidence.between(evidence.base, true) > 30.0 > 0.0 > evidence.between(true, evidence.base)


def test_power_that_rounding_leaves_is_no_physics(evidence: Evidence) -> None:
    rounded = Evidence(evidence.problem, evidence.base, np.full(3, 1e9))
    assert rounded.left(evidence.base) == 0.0


def test_a_fit_is_split_once(evidence: Evidence) -> None:
    first = evidence.split(evidence.base)
    assert evidence.split(evidence.base) is first
    assert np.array_equal(split_of(evidence.problem, evidence.base).physics, first.physics)


def test_errors_that_stay_the_same_count_less_than_one_each() -> None:
    assert colour(left(300.0, rows=3000)) > 20.0
