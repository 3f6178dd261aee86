"""Odds: Bayes' where every window agrees, modest where windows disagree."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects._fit import Point
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._odds import Candidate, remains, weights_of
from tests.hil.analysis.missing_effects.turning_mass import base

_MODEL = base(0.5)
_POINT = Point(Hypothesis(_MODEL, _MODEL.parameters), (), ())


def _candidate(windows: list[float]) -> Candidate:
    return Candidate(_POINT, np.array(windows), 3, 20)


def _weights(*windows: list[float]) -> np.ndarray:
    return weights_of([_candidate(one) for one in windows], np.array(windows), 1000.0)


def test_windows_that_agree_give_the_odds_of_bayes() -> None:
    weights = _weights([0.1] * 20, [0.0] * 20)
    assert weights[0] == pytest.approx(1.0 / (1.0 + np.exp(-2.0)), abs=0.01)


def test_windows_that_disagree_make_large_differences_modest() -> None:
    better_here_worse_there = [30.0, -20.0] * 10
    weights = _weights(better_here_worse_there, [0.0] * 20)
    assert 0.6 < weights[0] < 0.97  # Bayes would have e^100 to 1


def test_a_free_number_costs_half_the_logarithm_of_the_values() -> None:
    small, large = _candidate([0.0]), Candidate(_POINT, np.zeros(1), 4, 20)
    assert small.score(400.0) - large.score(400.0) == pytest.approx(0.5 * np.log(400.0))


_NOISE = np.array([1.0, 1.0, 1.0])


def test_what_stays_beyond_noise_counts_where_there_is_any() -> None:
    had, has = np.array([100.0, 1.0, np.nan]), np.array([26.5, 1.0, np.nan])
    assert remains(had, has, _NOISE, 2.0 * _NOISE) == pytest.approx(24.5 / 98.0)


def test_nothing_stays_where_all_may_be_slow_noise_and_more_was_taken_off() -> None:
    had, has = np.array([2.5, 1.1, 1.1]), np.array([1.3, 1.1, 1.1])
    assert remains(had, has, _NOISE, 2.76 * _NOISE) == 0.0


def test_a_tenth_of_the_noise_is_no_name() -> None:
    had, has = np.array([1.5, 1.0, 1.0]), np.array([1.4, 1.0, 1.0])
    assert remains(had, has, _NOISE, 2.76 * _NOISE) > 0.5
