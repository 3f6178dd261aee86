"""Standard errors hold what they claim where errors are slow."""

import dataclasses

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis.fit.covariance import standard_errors
from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.fit import Fit
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, left, one_problem

BLOCKS = 5000


def fitted_mean(noise: np.ndarray) -> Fit:
    """Least squares of one number, the mean of the first channel, from errors of known kind."""
    one = left(1.0, rows=3 * BLOCKS)
    slopes = np.zeros((3 * BLOCKS, len(one.theta)))
    slopes[::3, 0] = 1.0
    rows = np.zeros(3 * BLOCKS)
    rows[::3] = noise - noise.mean()
    covariance = np.zeros((len(one.theta),) * 2)
    covariance[0, 0] = 1.0 / BLOCKS
    errors = (Errors(rows, slopes, np.zeros((3 * BLOCKS, 3))),)
    return dataclasses.replace(one, covariance=covariance, errors=errors, cost=float(rows @ rows))


def test_white_noise_has_the_error_of_a_mean() -> None:
    problem = one_problem(seconds=20.0)
    noise = np.random.default_rng(1).normal(size=BLOCKS)
    assert standard_errors(problem, fitted_mean(noise))[0] == pytest.approx(BLOCKS**-0.5, rel=0.35)


def test_slow_noise_has_a_larger_one() -> None:
    """AR(1) with pole p: the mean's variance grows by (1 + p)/(1 - p)."""
    problem = one_problem(seconds=20.0)
    pole = 0.98
    noise = np.sqrt(1 - pole**2) * lfilter([1.0], [1.0, -pole], np.random.default_rng(2).normal(size=BLOCKS))
    expected = np.sqrt((1 + pole) / (1 - pole) / BLOCKS)
    assert standard_errors(problem, fitted_mean(noise))[0] == pytest.approx(expected, rel=0.4)


def test_slow_noise_counts_in_full_where_a_number_shows_in_two_stretches() -> None:
    """A limit that is reached twice: the fit made its pulls there cancel; other stretches know the noise."""
    problem, pole, length = one_problem(seconds=20.0), 0.98, 150
    shows = np.zeros(BLOCKS, dtype=bool)
    shows[1000 : 1000 + length] = shows[3500 : 3500 + length] = True
    lags = np.abs(np.subtract.outer(np.flatnonzero(shows), np.flatnonzero(shows)))
    expected = np.sqrt(np.sum(pole**lags)) / (2 * length)
    for seed in range(5):
        rng = np.random.default_rng(seed)
        noise = np.sqrt(1 - pole**2) * lfilter([1.0], [1.0, -pole], rng.normal(size=BLOCKS))
        fit = fitted_mean(noise)
        rows, slopes = np.zeros(3 * BLOCKS), np.zeros((3 * BLOCKS, len(fit.theta)))
        slopes[::3, 0] = shows
        rows[::3] = noise - shows * noise[shows].mean()
        covariance = fit.covariance * BLOCKS / (2 * length)
        errors = (Errors(rows, slopes, np.zeros((3 * BLOCKS, 3))),)
        fit = dataclasses.replace(fit, covariance=covariance, errors=errors, cost=float(rows @ rows))
        assert standard_errors(problem, fit)[0] == pytest.approx(expected, rel=0.3)


def test_a_misfit_counts_and_known_errors_win() -> None:
    problem = one_problem(seconds=20.0)
    noise = np.random.default_rng(3).normal(size=BLOCKS)
    far = dataclasses.replace(fitted_mean(noise), cost=400.0 * problem.rows)
    assert standard_errors(problem, far)[0] == pytest.approx(20.0 * BLOCKS**-0.5, rel=0.05)
    told = dataclasses.replace(far, standard=np.full(len(far.theta), 0.5))
    assert standard_errors(problem, told)[0] == 0.5


def test_an_extra_dead_time_is_known_no_better_than_the_models_own() -> None:
    """Only their sum shows: 8 ms that may be off by 1.5 % leave 0.12 ms."""
    problem = one_problem(seconds=20.0)
    late = left(float(3 * BLOCKS), EffectUse("dead_time", {"extra_delay_s": 0.004}), rows=3 * BLOCKS)
    late = dataclasses.replace(late, covariance=1e-12 * np.eye(len(late.theta)))
    assert standard_errors(problem, late)[-1] == pytest.approx(
        0.015 * MODEL.parameters["torque_delay"], rel=1e-3
    )
