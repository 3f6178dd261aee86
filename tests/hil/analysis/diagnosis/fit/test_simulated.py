"""What a hypothesis shows, from the initial values that suit it."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._simulated import settled_starts, simulated_samples
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_problem


def test_settled_starts_undo_a_wrong_one() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta = hypothesis.start()
    wrong = [problem.first_starts()[0] + np.array([30.0, 3.0, 50.0, 0.0, 0.0])]
    settled = settled_starts(problem, hypothesis, theta, wrong)
    error = simulated_samples(problem, hypothesis, theta, settled)[0] - problem.traces[0].samples
    assert np.std(error, axis=0) == pytest.approx(NOISE, rel=0.1)


def test_an_axle_that_begins_at_rest_is_held_there_by_a_model_that_fits_badly() -> None:
    """A speed of its own at the start would hide part of what the model misses."""
    problem = one_problem()
    assert problem.resting == (True,)
    heavier = MODEL.with_parameters(vehicle_inertia=1.5 * MODEL.parameters["vehicle_inertia"])
    hypothesis = Hypothesis(heavier)
    (start,) = settled_starts(problem, hypothesis, hypothesis.start(), problem.first_starts())
    assert np.all(start[:2] == 0.0)
