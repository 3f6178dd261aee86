"""A hypothesis at its best."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import cheapest, fit, started_from
from hil.analysis.diagnosis.fit.problem import problem_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem, one_trace

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})
GUESS = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 1.0})


def test_a_hidden_number_is_found_with_its_error() -> None:
    problem = one_problem(OFFSET)
    found = fit(problem, Hypothesis(MODEL, (GUESS,)))
    assert found.theta[-1] == pytest.approx(20.0, abs=5.0 * np.sqrt(found.covariance[-1, -1]))
    assert found.cost == pytest.approx(problem.rows, rel=0.15)
    assert found.total == found.cost + found.prior
    assert found.angles is problem.angles


def test_numbers_are_carried_to_a_larger_hypothesis() -> None:
    problem = one_problem()
    parent = fit(problem, Hypothesis(MODEL), rounds=1)
    theta = started_from(parent, parent.hypothesis.with_term(GUESS))
    assert np.array_equal(theta[:-1], parent.theta)
    assert theta[-1] == 1.0


def test_the_cheapest_of_several_sizes_is_taken() -> None:
    problem, hypothesis = one_problem(OFFSET), Hypothesis(MODEL, (GUESS,))
    tried = [hypothesis.start() for _ in range(3)]
    for theta, value in zip(tried, (0.0, 18.0, 40.0), strict=True):
        theta[-1] = value
    starts = problem.first_starts()
    assert cheapest(problem, hypothesis, tried, starts) is tried[1]
    assert cheapest(problem, hypothesis, tried, starts, lead=1e9) is tried[0]


def test_a_number_in_a_large_unit_is_not_taken_for_known() -> None:
    """Nothing is known better than with all other numbers given (Cramér and Rao)."""
    trace = one_trace()
    shaft_alone = np.array([np.nan, np.nan, 1.0])
    seen = dataclasses.replace(
        trace, measured=trace.measured * shaft_alone, samples=trace.samples * shaft_alone
    )
    problem = problem_of([seen], noise_levels([trace]) / 30.0, MODEL.parameters["gear_ratio"])
    cubic = EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": 1000.0})
    found = fit(problem, Hypothesis(MODEL, (cubic,)), rounds=0)
    told = sum(np.sum(errors.by_coordinate**2, axis=0) for errors in found.errors)
    assert found.covariance[-1, -1] > 0.5 / told[-1]
