"""Another minimum of a play is looked for around where a fit ended."""

from __future__ import annotations

import pytest

from hil.analysis.missing_effects._fit import linearised, point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._screen import other_minimum
from hil.core.model import EffectUse
from tests.hil.analysis.missing_effects.chain import NUMBERS, chirp_problem

_GAP_RAD = 0.01


def _asked(gap_rad: float, reach: float) -> tuple[float, float]:
    """Growth of log L that is promised, and the half gap in rad where a fit would begin."""
    problem = chirp_problem(1.0, EffectUse("backlash", {"half_gap_rad": _GAP_RAD}))
    hypothesis = Hypothesis(problem.model, dict(NUMBERS))
    hypothesis = hypothesis.with_term(EffectUse("backlash", {"half_gap_rad": gap_rad}))
    point = point_at(problem, hypothesis)
    weighed = problem.weighed_by(point.powers(problem).spectrum(problem.noise))
    gain, begins = other_minimum(weighed, linearised(weighed, point), reach)
    return gain, float(begins.terms[0].values["half_gap_rad"])


def test_a_gap_that_is_a_fifth_too_wide_finds_the_right_one() -> None:
    gain, gap_rad = _asked(1.2 * _GAP_RAD, 1.0)
    assert gain > 100.0
    assert gap_rad == pytest.approx(_GAP_RAD, rel=0.02)


def test_it_is_not_looked_for_further_than_asked() -> None:
    _, gap_rad = _asked(1.2 * _GAP_RAD, 0.25)
    assert gap_rad > 1.1 * _GAP_RAD


def test_where_a_fit_is_at_its_best_nothing_else_is_promised() -> None:
    gain, _ = _asked(_GAP_RAD, 1.0)
    assert gain < 1.0
