"""Steps within bounds, and descents that reach the minimum."""

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.least_squares import Hopeless, box_step, descent
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

MATRIX = np.array([[2.0, 1.0], [1.0, 3.0]])


@pytest.mark.parametrize(
    ("lower", "upper", "step"),
    [
        ((-9.0, -9.0), (9.0, 9.0), (0.2, 0.6)),
        ((-9.0, -9.0), (0.1, 9.0), (0.1, 1.9 / 3.0)),
        ((-9.0, -9.0), (9.0, 0.5), (0.25, 0.5)),
        ((0.3, -9.0), (9.0, 0.5), (0.3, 0.5)),
    ],
)
def test_a_step_within_bounds(
    lower: tuple[float, float], upper: tuple[float, float], step: tuple[float, float]
) -> None:
    found = box_step(MATRIX, np.array([1.0, 2.0]), np.array(lower), np.array(upper))
    assert found == pytest.approx(step)


def test_without_numbers_to_go_by_no_step_is_taken() -> None:
    assert np.all(box_step(np.full((2, 2), np.nan), np.ones(2), -np.ones(2), np.ones(2)) == 0.0)


def test_a_descent_lowers_the_cost_and_keeps_to_its_rounds() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta = hypothesis.start() + 0.02
    starts = problem.first_starts()
    wide = np.full(len(theta), 0.03)
    first = problem.linearised(hypothesis, theta, starts)
    reached = descent(problem, hypothesis, (theta, starts), (-wide, wide), np.zeros(len(theta)), 3, 0.0)
    assert reached.at.cost < 0.5 * first.cost
    assert reached.rounds <= 3
    assert np.all(np.abs(reached.theta) <= wide)


@pytest.mark.parametrize(("leaves", "ends"), [(0.0, True), (np.inf, False)])
def test_a_descent_that_is_far_behind_is_given_up(leaves: float, ends: bool) -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta = hypothesis.start() + 0.02
    within, free = (theta - 0.1, theta + 0.1), np.zeros(len(theta))
    begin = theta, problem.first_starts()
    reached = descent(
        problem, hypothesis, begin, within, free, 4, 0.0, hopeless=Hopeless(1, leaves * problem.rows)
    )
    assert (reached.rounds == 1) is ends


def test_errors_far_beyond_noise_lead_to_one_minimum_from_either_side() -> None:
    offset = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})
    problem, hypothesis = one_problem(offset), Hypothesis(MODEL)
    starts = problem.first_starts()
    wide = np.full(len(hypothesis.start()), 0.5)
    free = np.zeros(len(wide))
    ends = [
        descent(problem, hypothesis, (hypothesis.start() + by, starts), (-wide, wide), free, 40, 1e-3)
        for by in (-0.03, 0.03)
    ]
    assert ends[0].at.cost > 10.0 * problem.rows
    assert ends[0].at.cost == pytest.approx(ends[1].at.cost, rel=1e-6)
    assert max(one.rounds for one in ends) < 40
