"""Descents that begin near a fit, by the derivatives that it has.

Derivatives cost a simulation for each number and each initial value; near where they were taken they serve
again, and a step costs as many simulations as lengths of it are tried.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._errors import Errors
from hil.analysis.diagnosis.fit._fit import Fit, bounds_of, precision_of
from hil.analysis.diagnosis.fit._least_squares import box_step
from hil.analysis.diagnosis.fit._normal import reduced, start_step
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.fit._thresholds import SLIDE_ROUNDS, TRIALS

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Slid:
    """Where a descent by another fit's derivatives ended: `total` as that of a fit."""

    theta: Array
    starts: list[Array]
    total: float


def slid(problem: Problem, near: Fit, theta: Array, starts: list[Array]) -> Slid:
    """Go down from `theta` and `starts` by the derivatives of the fit `near`, while it gains something.

    Raises:
        OutOfTimeError: the problem's allowance is used up.
    """
    lower, upper = bounds_of(near.hypothesis)
    precision = precision_of(problem, near.hypothesis)
    theta = np.clip(theta, lower, upper)
    shares: tuple[float, ...] = (0.0,)  # where it begins is looked at first
    step, now, errors = np.zeros(len(theta)), np.inf, near.errors
    steps = [np.zeros(len(start)) for start in starts]
    for _ in range(SLIDE_ROUNDS):
        thetas = [theta + share * step for share in shares]
        each = [np.stack([s + share * d for share in shares]) for s, d in zip(starts, steps, strict=True)]
        tried = problem.tried([near.hypothesis.packed(t) for t in thetas], each)
        totals = tried.costs + np.array([float(precision @ t**2) for t in thetas])
        best = int(np.argmin(totals))
        if not totals[best] < now:
            break
        theta, starts, now = thetas[best], [one[best] for one in each], float(totals[best])
        errors = tuple(
            Errors(r[best], e.by_coordinate, e.by_start) for r, e in zip(tried.rows, near.errors, strict=True)
        )
        normals = problem.normals(errors, starts)
        matrix, gradient = reduced(normals)
        step = box_step(
            matrix + np.diag(precision), gradient - precision * theta, lower - theta, upper - theta
        )
        steps = [start_step(n, step) for n in normals]
        shares = TRIALS
    return Slid(theta, starts, now)
