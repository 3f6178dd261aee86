"""Descents by the derivatives of a fit nearby."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.far import slid
from hil.analysis.diagnosis.fit.fit import fit, fitted_on
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def test_from_near_a_fit_it_slides_back_to_it() -> None:
    problem = one_problem()
    one = fit(problem, Hypothesis(MODEL))
    moved = one.theta + 1e-3 * np.cos(np.arange(len(one.theta)))
    found = slid(problem, one, moved, one.starts)
    assert fit(problem, one.hypothesis, one.starts, moved, rounds=0).total > one.total + 10.0
    assert found.total == pytest.approx(one.total, abs=0.5)
    assert found.theta == pytest.approx(one.theta, abs=1e-4)


def test_what_it_says_is_left_is_left() -> None:
    problem = one_problem()
    one = fit(problem, Hypothesis(MODEL))
    found = slid(problem, one, one.theta + 1e-3, one.starts)
    there = fit(problem, one.hypothesis, found.starts, found.theta, rounds=0)
    assert found.total == pytest.approx(there.total, rel=1e-9)


def test_a_fit_that_ended_early_goes_on_as_if_it_had_not() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta = hypothesis.start() + 0.02
    early = fit(problem, hypothesis, None, theta, rounds=1)
    assert early.rounds == 1
    whole = fit(problem, hypothesis, None, theta)
    assert fitted_on(problem, early).total == pytest.approx(whole.total, abs=1.0)  # the gain that ends a fit
