"""Errors and derivatives of a hypothesis over recordings, and that a problem stays as it is."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._problem import problem_of
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_problem, one_trace

RATIO = MODEL.parameters["gear_ratio"]


def test_the_true_model_leaves_one_noise_variance_a_row() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    starts = problem.first_starts()
    at = problem.linearised(hypothesis, hypothesis.start(), starts)
    assert at.cost == pytest.approx(problem.rows, rel=0.15)
    costs = problem.costs([hypothesis.packed(hypothesis.start())], [np.stack(starts)])
    assert costs[0] == pytest.approx(at.cost)
    assert at.errors[0].channels.shape == problem.traces[0].measured.shape
    assert at.errors[0].by_coordinate.shape == (problem.rows, len(hypothesis.coordinates()))


def test_a_derivative_is_what_the_error_does() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta, starts = hypothesis.start(), problem.first_starts()
    at = problem.linearised(hypothesis, theta, starts)
    index = [c.name for c in hypothesis.coordinates()].index("vehicle_inertia")
    theta[index] += 0.01
    moved = problem.linearised(hypothesis, theta, starts)
    change = at.errors[0].rows - moved.errors[0].rows
    assert change == pytest.approx(0.01 * at.errors[0].by_coordinate[:, index], abs=0.02 * np.ptp(change))


def test_a_channel_that_is_missing_weighs_nothing() -> None:
    trace = one_trace()
    measured = trace.measured.copy()
    measured[:, 2] = np.nan
    problem = problem_of([dataclasses.replace(trace, measured=measured)], np.array(NOISE), RATIO)
    assert problem.weights[0][2] == 0.0
    assert problem.channels == 2
    assert np.all(problem.errors(0, np.zeros_like(measured))[:, 2] == 0.0)


def test_a_simulation_that_diverges_costs_much_and_not_nan() -> None:
    problem = one_problem()
    assert np.all(np.isfinite(problem.errors(0, np.full_like(problem.traces[0].measured, np.nan))))


def test_an_axle_at_rest_is_held_there() -> None:
    problem = one_problem()
    assert problem.resting == (True,)
    assert np.all(problem.start_precision(0)[:2] > 0.0)
    away = dataclasses.replace(problem.traces[0], start=np.array([100.0, 12.0, 0.0]))
    moving = problem_of([away], np.array(NOISE), RATIO)
    assert moving.resting == (False,)
    assert np.all(moving.start_precision(0)[:3] == 0.0)
    assert np.all(moving.start_precision(0)[3:] < 0.1 * problem.start_precision(0)[3:])
    assert moving.first_starts()[0] == pytest.approx([100.0, 12.0, 0.0, 0.0, 0.0])


def test_nothing_of_a_problem_can_be_changed() -> None:
    problem = one_problem()
    with pytest.raises(dataclasses.FrozenInstanceError):
        problem.angles = ()  # type: ignore[misc]
    for shared in (problem.noise, problem.floor, problem.weights[0]):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 1.0


def test_other_angles_make_another_problem() -> None:
    problem = one_problem()
    other = problem.with_angles([problem.angles[0] + 1.0])
    assert np.ptp(other.angles[0] - problem.angles[0]) < 1e-9 < other.angles[0][0, 0]
    hypothesis = Hypothesis(MODEL)
    again = other.following(hypothesis, hypothesis.start())
    assert np.array_equal(again.angles[0], problem.angles[0])


def test_noise_that_the_caller_changes_later_does_not_reach_a_problem() -> None:
    noise = np.array(NOISE)
    problem = problem_of([one_trace()], noise, RATIO)
    noise[0] = 99.0
    assert problem.noise[0] == NOISE[0]
