"""Errors of hypotheses, and what a prior takes."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.core.model import EffectUse
from tests.hil.analysis.missing_effects.chain import NUMBERS, chirp_problem


def test_what_runs_away_is_far_off_and_not_the_likeliest_of_all() -> None:
    problem = chirp_problem(1.0)
    right = Hypothesis(problem.model, dict(NUMBERS))
    stiffness = EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": -1e9})
    away = point_at(problem, right.with_term(stiffness))
    assert all(np.all(np.isfinite(error)) for error in away.errors)
    done = Candidates(problem)
    assert done.judged(away).log_likelihood < done.judged(point_at(problem, right)).log_likelihood - 100.0


def test_a_gain_far_from_one_costs_as_much_as_a_number_that_is_as_far_off() -> None:
    problem = chirp_problem(1.0)
    numbers = dict(NUMBERS)
    off = Hypothesis(problem.model, {**numbers, "motor_inertia": 1.3 * numbers["motor_inertia"]})
    gain = Hypothesis(problem.model, numbers).with_term(EffectUse("torque_gain", {"gain": 1.3}))
    done = Candidates(problem)
    by_number, by_gain = (done.judged(point_at(problem, one)).prior for one in (off, gain))
    assert by_gain == pytest.approx(by_number, rel=0.1)
    assert by_gain < -3.0


def test_a_base_that_is_far_off_says_nothing_but_its_teeth() -> None:
    problem = chirp_problem(1.0)
    base = Hypothesis(problem.model, dict(problem.model.parameters))
    softer, geared = base.with_number("shaft_stiffness", 4000.0), base.with_number("gear_ratio", 8.4)
    assert problem.log_prior(softer) < -4.0
    assert problem.log_prior(softer, far=True) == problem.log_prior(base, far=True) == 0.0
    assert problem.log_prior(geared, far=True) == problem.log_prior(geared) < -4.0
