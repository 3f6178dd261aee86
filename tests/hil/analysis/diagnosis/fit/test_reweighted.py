"""Only a fit far from the noise is weighed anew."""

import dataclasses

import numpy as np

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.covariance import standard_errors
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.reweighted import reweighted
from hil.analysis.diagnosis.fit.thresholds import MISS_WORSE
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

LAG = EffectUse("actuator_lag", {"time_constant_s": 0.005})


def test_a_fit_near_the_noise_is_left_alone() -> None:
    problem = one_problem()
    one = fit(problem, Hypothesis(MODEL, (LAG,)), rounds=0)
    near = dataclasses.replace(one, cost=float(problem.rows))
    assert reweighted(problem, near) is near


def test_a_base_model_is_never_weighed_anew() -> None:
    problem = one_problem()
    far = dataclasses.replace(fit(problem, Hypothesis(MODEL), rounds=0), cost=1e9)
    assert reweighted(problem, far) is far


def test_a_fit_far_from_the_noise_keeps_its_plain_cost() -> None:
    slow = EffectUse("actuator_lag", {"time_constant_s": 0.2})
    problem = one_problem(slow, EffectUse("backlash", {"half_gap_rad": 0.05}))
    one = fit(problem, Hypothesis(MODEL, (LAG,)), rounds=2)
    if one.cost < 60.0 * problem.rows:
        one = dataclasses.replace(one, cost=60.0 * problem.rows)
    again = reweighted(problem, one)
    plain = fit(problem, again.hypothesis, again.starts, again.theta, rounds=0)
    assert again.cost == plain.cost
    assert again.standard is not None
    assert np.all(again.standard >= standard_errors(problem, plain))
    assert again.cost <= MISS_WORSE**2 * one.cost


def test_a_simulation_that_would_miss_by_more_keeps_its_weights() -> None:
    problem = one_problem(EffectUse("backlash", {"half_gap_rad": 0.05}))
    best = fit(problem, Hypothesis(MODEL, (EffectUse("backlash", {"half_gap_rad": 0.05}),)))
    far = dataclasses.replace(best, errors=fit(problem, Hypothesis(MODEL), rounds=0).errors)
    told = dataclasses.replace(far, cost=51.0 * problem.rows)
    assert reweighted(problem, told).cost <= MISS_WORSE**2 * told.cost
