"""A search that may take so long, and no longer."""

from dataclasses import replace

import pytest

from hil.analysis.diagnosis.fit.allowance import Allowance, OutOfTimeError
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def test_what_is_used_up_ends_every_fit_until_it_is_lifted() -> None:
    spent = Allowance(-1.0)
    problem = replace(one_problem(), allowance=spent)
    with pytest.raises(OutOfTimeError):
        fit(problem, Hypothesis(MODEL))
    spent.lift()
    assert fit(problem, Hypothesis(MODEL)).cost > 0.0


def test_without_a_bound_nothing_ends() -> None:
    Allowance().check()
