"""A play fitted past its false minima."""

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.growth import _past_false_minima
from hil.analysis.diagnosis.search.hopping import hopped
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def play(half_gap_rad: float) -> EffectUse:
    return EffectUse("backlash", EFFECTS["backlash"].completed({"half_gap_rad": half_gap_rad}))


def test_what_remembers_no_place_is_left_as_it_is() -> None:
    problem = one_problem()
    one = fit(problem, Hypothesis(MODEL))
    assert hopped(problem, one) is one


class Says:
    """Evidence that says what it is told to."""

    def __init__(self, problem: Problem, share: float, settled: bool) -> None:
        self.problem, self._share, self._settled = problem, share, settled

    def share(self, one: object) -> float:
        return self._share

    def settled(self, one: object) -> bool:
        return self._settled


@pytest.mark.parametrize(
    ("share", "settled", "leaves", "hops"),
    [(0.99, False, 4.0, True), (0.9, False, 4.0, False), (0.99, True, 4.0, False), (0.99, False, 6.0, False)],
)
def test_only_a_play_that_leaves_little_and_not_noise_hops_before_another_effect_is_looked_for(
    share: float, settled: bool, leaves: float, hops: bool
) -> None:
    problem = one_problem(play(0.012))
    one = fit(problem, Hypothesis(MODEL, (play(0.012),)), rounds=0)
    one = replace(one, cost=leaves * one.rows)
    found = _past_false_minima(Says(problem, share, settled), one)  # type: ignore[arg-type]
    assert (found is not one) is hops


@pytest.mark.slow
def test_it_ends_no_higher_and_nearer_to_the_truth_than_its_own_error() -> None:
    problem = one_problem(play(0.012), seconds=16.0)
    hypothesis = Hypothesis(MODEL).with_term(play(0.012))
    theta = hypothesis.start()
    names = [c.name for c in hypothesis.coordinates()]
    theta[names.index("shaft_stiffness")] += 0.008
    first = fit(problem, hypothesis, problem.first_starts(), theta)
    found = hopped(problem, first)
    assert found.total <= first.total
    assert found.scatter is not None
    assert np.all(found.scatter >= 0.0)
    off = abs(found.theta[names.index("half_gap_rad")] - np.log(0.012))
    assert off < max(3.0 * float(found.scatter[names.index("half_gap_rad")]), 2e-3)
    again = hopped(problem, first)
    assert np.array_equal(again.theta, found.theta)
