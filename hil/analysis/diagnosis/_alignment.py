"""Angles that ripples follow, corrected by the ripples themselves: in turns with a fit of everything else."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis._coordinates import Hypothesis
from hil.analysis.diagnosis._fit import Fit, fit
from hil.analysis.diagnosis._problem import Problem
from hil.analysis.diagnosis._tracking import RIPPLES, track

Array = npt.NDArray[np.float64]

_ROUNDS = 4
_LITTLE = 0.02  # share of what is left: a round that gains less is the last


def has_ripple(hypothesis: Hypothesis) -> bool:
    """Whether a hypothesis knows a torque that follows an angle."""
    return any(term.id in RIPPLES for term in hypothesis.terms)


def aligned(problem: Problem, one: Fit) -> Fit:
    """The fit again after the angles of `problem` were corrected by what its ripples show."""
    if not has_ripple(one.hypothesis):
        return one
    for _ in range(_ROUNDS):
        before = list(problem.angles)
        problem.follow(one.hypothesis, one.theta)
        theta = track(problem, one.hypothesis, one.theta, one.starts)
        again = fit(problem, one.hypothesis, one.starts, theta)
        if again.total >= one.total:
            problem.angles = before
            return one
        little = one.total - again.total < _LITTLE * (one.total - problem.rows)
        one = again
        if little:
            break
    return one
