"""Angles that ripples follow, corrected by the ripples themselves: in turns with a fit of everything else."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import settled_starts
from hil.analysis.diagnosis.search.thresholds import (
    ALIGNMENT_LITTLE,
    ALIGNMENT_ROUNDS,
    WHOLE_ORDER,
    WHOLE_WORSE,
    ZERO_DOUBTED,
    ZERO_WRONG,
)
from hil.analysis.diagnosis.search.tracking import RIPPLES, angle_known, track

Array = npt.NDArray[np.float64]


def has_ripple(hypothesis: Hypothesis) -> bool:
    """Whether a hypothesis or its base model knows a torque that follows an angle."""
    return adds_ripple(hypothesis) or any(use.id in RIPPLES for use in hypothesis.base.effects)


def adds_ripple(hypothesis: Hypothesis) -> bool:
    """Whether a hypothesis adds one to its base model."""
    return any(term.id in RIPPLES for term in hypothesis.terms)


def with_base_angles(problem: Problem, first: Fit) -> tuple[Problem, Fit]:
    """Angles corrected by the ripples that the base model knows, and its fit with them.

    A recording from rest is taken to begin at the angle from which the model's ripples count, as runs on a
    bench that was just switched on do; where this leaves much and another zero far less, it did not.
    """
    if not has_ripple(first.hypothesis):
        return problem, first
    counted = _base_in_turns(problem, first)
    left = counted[1].total - problem.rows
    if left < ZERO_DOUBTED * problem.rows or not any(
        map(partial(angle_known, problem), range(len(first.starts)))
    ):
        return counted
    free = _base_in_turns(replace(problem, zero_known=False), first)
    return free if free[1].total - problem.rows < ZERO_WRONG * left else counted


def _base_in_turns(problem: Problem, first: Fit) -> tuple[Problem, Fit]:
    """Track and fit while it gains something."""
    base = first.hypothesis
    theta, starts, turned = first.theta, first.starts, problem
    if not all(angle_known(problem, index) for index in range(len(starts))):
        theta = base.start()  # fitted parameters were bent to make up for a wrong phase
        for _ in range(ALIGNMENT_ROUNDS):
            starts = settled_starts(turned, base, theta, starts)
            _, turned = track(turned, base, theta, starts)
    for _ in range(ALIGNMENT_ROUNDS):
        _, turned = track(turned, base, theta, starts)
        again = fit(turned, base, starts, theta)
        gain = first.total - again.total
        if gain > 0.0:
            problem, first = turned, again
        if gain < ALIGNMENT_LITTLE * max(first.total - problem.rows, 0.5 * problem.rows):
            break
        theta, starts = again.theta, again.starts
    return problem, first


def aligned(problem: Problem, one: Fit) -> Fit:
    """The fit again, with angles corrected by what its ripples show."""
    if not adds_ripple(one.hypothesis):
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
