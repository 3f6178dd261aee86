"""A search that may take so long, and no longer."""

from dataclasses import replace

import pytest

from hil.analysis.missing_effects._allowance import Allowance, OutOfTimeError
from hil.analysis.missing_effects._fit import fit, point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis
from tests.hil.analysis.missing_effects.chain import chirp_problem


def test_what_is_used_up_ends_every_fit_until_it_is_lifted() -> None:
    spent = Allowance(-1.0)
    free = chirp_problem(1.1)
    problem = replace(free, allowance=spent)
    point = point_at(free, Hypothesis(problem.model, dict(problem.model.parameters)))
    with pytest.raises(OutOfTimeError):
        fit(problem, point, evaluations=2)
    spent.lift()
    assert fit(problem, point, evaluations=2).hypothesis is not point.hypothesis


def test_without_a_bound_nothing_ends() -> None:
    Allowance().check()
