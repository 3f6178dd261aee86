"""Stretches that no model predicts are found, and do not count."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.evidence import Evidence
from hil.analysis.diagnosis.search.hopping import hopped
from hil.analysis.diagnosis.search.predictable import _holds_most, left_out, predicted_where, where_predicted
from tests.hil.analysis.diagnosis.one_recording import MODEL
from tests.hil.analysis.diagnosis.played import SECONDS, supposed, with_play


def fitted(half_gap_rad: float) -> tuple[Problem, Fit, Fit]:
    """A recording, its base model fitted, and the true one from nearby as it is."""
    problem = with_play(half_gap_rad)
    base = fit(problem, Hypothesis(MODEL))
    return problem, base, fit(problem, supposed(1.01 * half_gap_rad), base.starts, rounds=0)


def test_a_small_play_is_predicted_throughout() -> None:
    assert predicted_where(*fitted(0.01)) is None
    assert where_predicted(*fitted(0.01)) is None


def test_where_a_wide_play_bounces_nobody_predicts_it() -> None:
    flags = predicted_where(*fitted(0.03))
    assert flags is not None
    time = np.linspace(0.0, SECONDS, len(flags[0]))
    assert flags[0][(time > 2.0) & (time < 8.0)].all()
    assert not flags[0][(time > 14.0) & (time < 15.0)].any()


def test_it_is_told_where_most_of_what_is_left_lies() -> None:
    problem, base, near = fitted(0.03)
    flags = predicted_where(problem, base, near)
    assert flags is not None
    length = 62  # blocks of a window
    apart = [~each[: len(each) // length * length : length] for each in flags]
    assert _holds_most(problem, near, apart)
    assert not _holds_most(problem, near, [~each for each in apart])
    assert not _holds_most(problem, near, [np.zeros_like(each) for each in apart])


@pytest.mark.slow
def test_elsewhere_it_is_fitted_and_judged() -> None:
    problem, base, near = fitted(0.03)
    found = where_predicted(problem, base, near)
    assert found is not None
    judged, one = found
    assert judged.partial
    assert 0.5 * problem.rows < judged.rows < 0.95 * problem.rows
    one = hopped(
        judged, one
    )  # a descent ends in a hollow beside the lowest, which one is a matter of rounding
    assert np.exp(one.theta[-1]) == pytest.approx(0.03, rel=0.003)
    assert Evidence(judged, fit(judged, base.hypothesis)).share(one) > 0.99
    assert left_out(problem) == []
    assert "the model does not predict" in left_out(judged)[0]
