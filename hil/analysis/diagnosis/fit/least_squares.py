"""Levenberg-Marquardt on the simulation error, with bounds on every coordinate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import lsq_linear

from hil.analysis.diagnosis.fit.coordinates import Coordinate, Hypothesis
from hil.analysis.diagnosis.fit.normal import promised_gain, reduced, start_step
from hil.analysis.diagnosis.fit.problem import Linearised, Problem
from hil.analysis.diagnosis.fit.thresholds import (
    AS_PROMISED,
    LONGER,
    LONGEST,
    MORE_THAN_PROMISED,
    MOST_REFUSALS,
    TRIALS,
)

Array = npt.NDArray[np.float64]

_RANK, _EXACT = 1e-13, 1e-12  # what rounding leaves of zero


def box_step(matrix: Array, gradient: Array, lower: Array, upper: Array) -> Array:
    """Minimiser of ½xᵀMx - gᵀx within bounds, the smallest one where M is singular."""
    if not (len(gradient) and np.isfinite(matrix).all() and np.isfinite(gradient).all()):
        return np.zeros(len(gradient))
    scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    lower, upper = lower / scale, upper / scale
    # What a fit has are normal equations: a root of theirs stands for the rows that they came from.
    values, vectors = np.linalg.eigh(matrix * np.outer(scale, scale))
    kept = values > _RANK * max(float(values[-1]), 1e-300)
    roots, vectors = np.sqrt(values[kept]), vectors[:, kept]
    rows, right = roots[:, None] * vectors.T, (vectors.T @ (gradient * scale)) / roots
    x = vectors @ (right / roots)
    if np.any((x < lower) | (x > upper)):
        above = np.maximum(upper, np.nextafter(lower, np.inf))  # a number that may not move
        x = lsq_linear(rows, right, (lower, above), method="bvls", tol=_EXACT).x
    return np.asarray(np.clip(x, lower, upper) * scale)


@dataclass(frozen=True)
class Reached:
    """Where a descent ended."""

    theta: Array
    starts: list[Array]
    at: Linearised
    rounds: int


@dataclass(frozen=True)
class Hopeless:
    """A descent that leaves more than `total` after so many rounds is given up."""

    rounds: int
    total: float


def descent(
    problem: Problem,
    hypothesis: Hypothesis,
    begin: tuple[Array, list[Array]],
    bounds: tuple[Array, Array],
    precision: Array,
    rounds: int,
    enough: float,
    at: Linearised | None = None,
    hopeless: Hopeless | None = None,
) -> Reached:
    """Levenberg-Marquardt within bounds, from coordinates and starts; `at` is the problem there, if known."""
    coordinates = hypothesis.coordinates()
    valley = _Valley(problem, hypothesis, *bounds, precision)
    lower, upper = bounds
    theta, starts = np.clip(begin[0], lower, upper), begin[1]
    at = at or problem.linearised(hypothesis, theta, starts)
    damping, refusals, done, fresh, shares = 1e-6, 0, 0, True, TRIALS
    smooth = not hypothesis.remembers_place  # a play's valley is rugged: a part of a step may gain more
    while done < rounds:
        now = at.cost + valley.price(theta)
        if hopeless and done == hopeless.rounds and now > hopeless.total:
            break
        matrix, gradient = reduced(at.normals)
        matrix = matrix + np.diag(precision)
        gradient = gradient - precision * theta
        damped = matrix + damping * np.diag(np.maximum(np.diag(matrix), 1e-12))
        step = box_step(damped, gradient, lower - theta, upper - theta)
        step = _limited(step, coordinates)
        promised = promised_gain(at.normals, matrix, gradient, step)
        if fresh and promised < enough:
            break
        done += 1
        here = Reached(theta, starts, at, done)
        went = valley.along(step, shares[:1] if smooth else shares, here)
        if smooth and (len(shares) > len(TRIALS) or not now - went.total > AS_PROMISED * promised):
            went = min(went, valley.along(step, shares[1:], here), key=lambda way: way.total)
        gain = now - went.total
        if gain <= 0.0 or not np.isfinite(gain):
            refusals, fresh = refusals + 1, False
            damping = max(damping * 30.0, 1e-3)
            if refusals > MOST_REFUSALS or float(step @ matrix @ step) < enough:
                break
            continue
        theta, starts = went.theta, went.starts
        damping = damping * 3.0 if went.share < 1.0 else damping / 10.0
        # errors beyond noise bend the valley: where it is flatter than derivatives say, steps fall short
        flat = went.share >= 1.0 and gain > MORE_THAN_PROMISED * promised
        shares = (*TRIALS, min(LONGER * went.share, LONGEST)) if flat else TRIALS
        at, fresh = problem.linearised(hypothesis, theta, starts, went.shown), True
        if gain < enough:
            break
    return Reached(theta, starts, at, done)


@dataclass(frozen=True)
class _Way:
    """Where a share of a step leads: the sum of squared errors there, and what is simulated."""

    share: float
    theta: Array
    starts: list[Array]
    total: float
    shown: list[Array]


@dataclass(frozen=True)
class _Valley:
    """What a descent goes down in."""

    problem: Problem
    hypothesis: Hypothesis
    lower: Array
    upper: Array
    precision: Array

    def price(self, theta: Array) -> float:
        """Of coordinates that are off what is known of them beforehand."""
        return float(self.precision @ theta**2)

    def along(self, step: Array, shares: Sequence[float], here: Reached) -> _Way:
        """The best of several shares of a step, each with the starts that suit it."""
        moved = [np.clip(here.theta + share * step, self.lower, self.upper) for share in shares]
        starts = [
            np.stack([start + start_step(n, theta - here.theta) for theta in moved])
            for start, n in zip(here.starts, here.at.normals, strict=True)
        ]
        tried = self.problem.tried([self.hypothesis.packed(theta) for theta in moved], starts)
        totals = tried.costs + np.array([self.price(theta) for theta in moved])
        best = int(np.argmin(totals))
        each, shown = ([one[best] for one in of] for of in (starts, tried.shown))
        return _Way(shares[best], moved[best], each, float(totals[best]), shown)


def _limited(step: Array, coordinates: tuple[Coordinate, ...]) -> Array:
    """No logarithmic coordinate moves by more than a factor of two at once."""
    largest = max((abs(s) for s, c in zip(step, coordinates, strict=True) if c.scale == "log"), default=0.0)
    return step * min(1.0, 0.7 / largest) if largest > 0.0 else step
