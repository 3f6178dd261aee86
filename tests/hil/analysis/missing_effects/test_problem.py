"""Errors of hypotheses, and what a prior takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import point_at, with_better_starts
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model
from tests.hil.analysis.missing_effects.chain import NUMBERS, chirp_problem, driven, problem_about


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
    far = replace(problem, far=True)
    assert far.log_prior(softer) == far.log_prior(base) == 0.0
    assert far.log_prior(geared) == problem.log_prior(geared) < -4.0


def test_windows_that_differ_in_their_torque_tell_slow_noise_and_alike_ones_do_not() -> None:
    """By a chirp, which is still in most windows of an octave; not by a multisine that repeats itself."""
    time = np.arange(60_000, dtype=np.float64) * 1e-3
    lines = 2.0 ** np.arange(-2, 6)
    swept = 40.0 * np.sin(2.0 * np.pi * (0.5 + 0.25 * time) * time)
    repeated = 10.0 * np.sum(np.sin(2.0 * np.pi * lines[:, None] * time + lines[:, None]), axis=0)
    rng = np.random.default_rng(5)
    slow = lfilter([1.0], [1.0, -0.98], rng.normal(size=(len(time), 3)), axis=0).T
    model = Model("two_inertia", NUMBERS)
    for torque, tells in ((swept, True), (repeated, False)):
        read = driven(model, torque, 0.002)
        sizes = {name: 1e-3 * np.std(read[name]) for name in OUTPUTS}
        drawn = {name: sizes[name] * one / np.std(one) for name, one in zip(OUTPUTS, slow, strict=True)}
        noisy = {name: values + drawn.get(name, 0.0) for name, values in read.channels.items()}
        problem = problem_about(model, replace(read, channels=noisy))
        errors = with_better_starts(problem, point_at(problem, Hypothesis(model, dict(NUMBERS)))).errors
        least, most = problem.noise_in(errors)
        square = problem.mean_square(errors)
        assert problem.tells_noise is tells
        assert np.all(most > square)
        assert np.all(most < (1.4 if tells else 1.5) * square)
        assert np.all(least < square)
        assert np.all(least > (0.6 if tells else 0.4) * square)
        assert np.all(least > 1.2 * problem.noise**2) == tells
