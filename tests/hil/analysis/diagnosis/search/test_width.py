"""The width of a play, from far, where least squares see but its bounces."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.search.places import width_of, window_errors, with_likely_width
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL
from tests.hil.analysis.diagnosis.played import supposed, with_play


@pytest.mark.parametrize("guess", [0.006, 0.06])
def test_a_width_is_found_from_far(guess: float) -> None:
    problem, hypothesis = with_play(0.02), supposed(guess)
    index = width_of(hypothesis)
    assert index is not None
    starts = problem.first_starts()
    theta = with_likely_width(problem, hypothesis, hypothesis.start(), starts, index)
    assert np.exp(theta[index]) == pytest.approx(0.02, rel=0.01)


def test_a_speed_that_is_off_throughout_says_nothing_of_a_window() -> None:
    problem, hypothesis = with_play(0.02), supposed(0.02)
    starts = problem.first_starts()
    starts[0][:2] += np.array([8.148, 1.0]) * 2.0
    errors = window_errors(problem, hypothesis, hypothesis.start(), starts)
    assert np.median(errors) == pytest.approx(1.0, abs=0.4)


def test_only_a_play_has_a_width() -> None:
    assert width_of(Hypothesis(MODEL).with_term(EffectUse("actuator_lag", {"time_constant_s": 0.01}))) is None
