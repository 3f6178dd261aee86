"""Angles that ripples follow, corrected by the ripples themselves: in turns with a fit of everything else."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._fit import Fit, fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.search._thresholds import (
    ALIGNMENT_LITTLE,
    ALIGNMENT_ROUNDS,
    WHOLE_ORDER,
    WHOLE_WORSE,
)
from hil.analysis.diagnosis.search._tracking import RIPPLES, track

Array = npt.NDArray[np.float64]


def has_ripple(hypothesis: Hypothesis) -> bool:
    """Whether a hypothesis knows a torque that follows an angle."""
    return any(term.id in RIPPLES for term in hypothesis.terms)


def aligned(problem: Problem, one: Fit) -> Fit:
    """The fit again, with angles corrected by what its ripples show."""
    if not has_ripple(one.hypothesis):
        return one
    best = _in_turns(problem, one, one.theta)
    for index, c in enumerate(best.hypothesis.coordinates()):
        whole = float(np.round(best.theta[index]))
        if (
            c.name == "order"
            and whole > 0.0
            and WHOLE_ORDER[0] < abs(best.theta[index] - whole) < WHOLE_ORDER[1]
        ):
            best = _with_whole_order(problem, best, index, whole)
    return best


def _in_turns(problem: Problem, one: Fit, theta: Array, *, order_known: bool = False) -> Fit:
    """Track and fit, from `theta`, while it makes `one` better."""
    for _ in range(ALIGNMENT_ROUNDS):
        again = _turn(problem, one, theta, order_known=order_known)
        if again.total >= one.total:
            return one
        little = one.total - again.total < ALIGNMENT_LITTLE * (one.total - problem.rows)
        one, theta = again, again.theta
        if little:
            break
    return one


def _turn(problem: Problem, one: Fit, theta: Array, *, order_known: bool) -> Fit:
    """The hypothesis of `one`, its ripples followed from `theta`, then fitted."""
    problem = problem.following(one.hypothesis, theta)
    theta, problem = track(problem, one.hypothesis, theta, one.starts, order_known=order_known)
    return fit(problem, one.hypothesis, one.starts, theta)


def _with_whole_order(problem: Problem, best: Fit, index: int, whole: float) -> Fit:
    """`best` from a whole order, its number `index`: what turns with a shaft repeats with every turn."""
    theta = best.theta.copy()
    theta[index] = whole
    first = _turn(problem, best, theta, order_known=True)
    other = _in_turns(problem, first, first.theta, order_known=True)
    return other if other.total < WHOLE_WORSE * best.total else best
