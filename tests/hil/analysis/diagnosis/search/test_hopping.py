"""A play fitted past its false minima."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._fit import fit
from hil.analysis.diagnosis.search._hopping import hopped
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def play(half_gap_rad: float) -> EffectUse:
    return EffectUse("backlash", EFFECTS["backlash"].completed({"half_gap_rad": half_gap_rad}))


def test_what_remembers_no_place_is_left_as_it_is() -> None:
    problem = one_problem()
    one = fit(problem, Hypothesis(MODEL))
    assert hopped(problem, one) is one


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
