"""Levenberg-Marquardt on the simulation error, with bounds on every coordinate."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis._coordinates import Coordinate, Hypothesis, key_of
from hil.analysis.diagnosis._problem import Normal, Problem, reduced, start_step
from hil.analysis.diagnosis._whole_samples import delay_by_samples

Array = npt.NDArray[np.float64]

_TRIALS = (1.0, 0.35)
_MOST_ROUNDS = 14
_MOST_REFUSALS = 4
_WORTH_A_LEAP = 10.0  # drop of the squared error


@dataclass
class Fit:
    """A hypothesis at its best: `cost` is the sum of squared weighted errors (1 per row for pure noise).

    `angles` are those that its ripples, if any, follow.
    """

    hypothesis: Hypothesis
    theta: Array
    starts: list[Array]
    cost: float
    prior: float
    covariance: Array
    normals: list[Normal] = field(repr=False)
    pieces: list[tuple[Array, Array, Array]] = field(repr=False)
    rounds: int = 0
    angles: list[Array] = field(default_factory=list, repr=False)

    @property
    def total(self) -> float:
        """Cost with the price of parameter corrections."""
        return self.cost + self.prior


def box_step(matrix: Array, gradient: Array, lower: Array, upper: Array) -> Array:
    """Minimiser of ½xᵀMx - gᵀx within bounds, by an active set."""
    size = len(gradient)
    if not (np.isfinite(matrix).all() and np.isfinite(gradient).all()):
        return np.zeros(size)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    matrix, gradient = matrix * np.outer(scale, scale), gradient * scale
    lower, upper = lower / scale, upper / scale
    reach = float(np.max(np.abs(gradient), initial=1e-300))
    x = np.zeros(size)
    free = np.ones(size, bool)
    for _ in range(3 * size + 3):
        x_free = np.linalg.lstsq(
            matrix[np.ix_(free, free)], gradient[free] - matrix[np.ix_(free, ~free)] @ x[~free], rcond=1e-13
        )[0]
        trial = x.copy()
        trial[free] = x_free
        outside = free & ((trial < lower) | (trial > upper))
        if outside.any():
            over = np.where(trial < lower, lower - trial, trial - upper)
            over = np.where(outside, over / np.maximum(upper - lower, 1e-30), -np.inf)
            worst = int(np.argmax(over))
            x[worst] = lower[worst] if trial[worst] < lower[worst] else upper[worst]
            free[worst] = False
            continue
        x = trial
        pull = gradient - matrix @ x
        release = ~free & (((x <= lower) & (pull > 1e-9 * reach)) | ((x >= upper) & (pull < -1e-9 * reach)))
        if not release.any():
            break
        free[int(np.argmax(np.where(release, np.abs(pull), -1.0)))] = True
    return np.clip(x, lower, upper) * scale


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    starts: list[Array] | None = None,
    theta: Array | None = None,
    *,
    rounds: int = _MOST_ROUNDS,
    enough: float = 1.0,
) -> Fit:
    """Minimise the simulation error of `hypothesis` from `theta` and `starts`.

    Args:
        enough: stop when a step gains less than this in the sum of squared errors.
    """
    coordinates = hypothesis.coordinates()
    lower, upper = _bounds(coordinates)
    theta = np.clip(hypothesis.start() if theta is None else theta, lower, upper)
    starts = [s.copy() for s in (starts or problem.first_starts(hypothesis))]
    precision = np.array([1.0 / c.prior**2 for c in coordinates])
    by_samples = delay_by_samples(hypothesis, problem.traces[0].dt) if rounds else None
    done = 0
    while True:
        within = lower, upper
        if by_samples is not None:
            tried = [theta, *by_samples.leaps(theta, lower, upper)]
            leapt = cheapest(problem, hypothesis, tried, starts, precision, lead=_WORTH_A_LEAP)
            if done and leapt is theta:
                break
            theta = leapt
            within = by_samples.within(theta, lower, upper)
        reached = _descent(problem, hypothesis, (theta, starts), within, precision, rounds - done, enough)
        theta, starts, done = reached.theta, reached.starts, done + reached.rounds
        if by_samples is None or done >= rounds:
            break
    matrix, _ = reduced(reached.normals)
    covariance = np.asarray(np.linalg.pinv(matrix + np.diag(precision), hermitian=True), dtype=float)
    prior = float(precision @ theta**2) + (by_samples.coincidence(theta) if by_samples is not None else 0.0)
    angles = list(problem.angles)
    return Fit(
        hypothesis,
        theta,
        starts,
        reached.cost,
        prior,
        covariance,
        reached.normals,
        reached.pieces,
        done,
        angles,
    )


@dataclass
class _Reached:
    """Where a descent ended."""

    theta: Array
    starts: list[Array]
    cost: float
    normals: list[Normal]
    pieces: list[tuple[Array, Array, Array]]
    rounds: int


def _descent(
    problem: Problem,
    hypothesis: Hypothesis,
    begin: tuple[Array, list[Array]],
    bounds: tuple[Array, Array],
    precision: Array,
    rounds: int,
    enough: float,
) -> _Reached:
    """Levenberg-Marquardt within bounds, from coordinates and starts."""
    coordinates = hypothesis.coordinates()
    lower, upper = bounds
    theta, starts = np.clip(begin[0], lower, upper), begin[1]
    cost, normals, pieces = problem.linearised(hypothesis, theta, starts)
    damping, refusals, done = 1e-6, 0, 0
    while done < rounds:
        done += 1
        matrix, gradient = reduced(normals)
        matrix = matrix + np.diag(precision)
        gradient = gradient - precision * theta
        damped = matrix + damping * np.diag(np.maximum(np.diag(matrix), 1e-12))
        step = box_step(damped, gradient, lower - theta, upper - theta)
        step = _limited(step, coordinates)
        tried_theta = [theta + share * step for share in _TRIALS]
        tried_starts = [
            np.stack([start + start_step(n, share * step) for share in _TRIALS])
            for start, n in zip(starts, normals, strict=True)
        ]
        found = problem.costs([hypothesis.packed(t) for t in tried_theta], tried_starts)
        totals = found + np.array([float(precision @ t**2) for t in tried_theta])
        best = int(np.argmin(totals))
        gain = cost + float(precision @ theta**2) - float(totals[best])
        if gain <= 0.0 or not np.isfinite(gain):
            refusals += 1
            damping = max(damping * 30.0, 1e-3)
            if refusals > _MOST_REFUSALS or float(step @ matrix @ step) < enough:
                break
            continue
        theta = tried_theta[best]
        starts = [s[best] for s in tried_starts]
        damping = damping / 10.0 if best == 0 else damping * 3.0
        cost, normals, pieces = problem.linearised(hypothesis, theta, starts)
        if gain < enough:
            break
    return _Reached(theta, starts, cost, normals, pieces, done)


def cheapest(
    problem: Problem,
    hypothesis: Hypothesis,
    tried: list[Array],
    starts: list[Array],
    precision: Array | float = 0.0,
    *,
    lead: float = 0.0,
) -> Array:
    """Those of the coordinates `tried` that leave the smallest error, unfitted.

    Args:
        lead: what the others must gain over the first in the sum of squared errors.
    """
    each = [np.tile(start, (len(tried), 1)) for start in starts]
    costs = problem.costs([hypothesis.packed(theta) for theta in tried], each)
    costs += np.array([np.sum(precision * theta**2) for theta in tried])
    costs[0] -= lead
    return tried[int(np.argmin(costs))]


def _bounds(coordinates: tuple[Coordinate, ...]) -> tuple[Array, Array]:
    return np.array([c.lower for c in coordinates]), np.array([c.upper for c in coordinates])


def carried(parent: Fit, hypothesis: Hypothesis) -> Array:
    """Coordinates of `hypothesis`: those that `parent` has by their fitted values, others by their start."""
    terms = {key_of(t): i for i, t in enumerate(parent.hypothesis.terms)}
    known = {(c.name, c.term): v for c, v in zip(parent.hypothesis.coordinates(), parent.theta, strict=True)}
    values = hypothesis.start()
    wrong = {str(t.values["parameter"]) for t in hypothesis.terms if t.id == "parameter_mismatch"}
    for index, c in enumerate(hypothesis.coordinates()):
        term = -1 if c.term < 0 else terms.get(key_of(hypothesis.terms[c.term]), -2)
        if term == -1 and c.name in wrong and ("parameter_mismatch", c.name) not in terms:
            continue
        values[index] = known.get((c.name, term), values[index])
    return values


def _limited(step: Array, coordinates: tuple[Coordinate, ...]) -> Array:
    """No logarithmic coordinate moves by more than a factor of two at once."""
    largest = max((abs(s) for s, c in zip(step, coordinates, strict=True) if c.scale == "log"), default=0.0)
    return step * min(1.0, 0.7 / largest) if largest > 0.0 else step
