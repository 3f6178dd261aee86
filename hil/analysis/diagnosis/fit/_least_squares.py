"""Levenberg-Marquardt on the simulation error, with bounds on every coordinate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._coordinates import Coordinate, Hypothesis
from hil.analysis.diagnosis.fit._normal import reduced, start_step
from hil.analysis.diagnosis.fit._problem import Linearised, Problem
from hil.analysis.diagnosis.fit._thresholds import MOST_REFUSALS, TRIALS

Array = npt.NDArray[np.float64]


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


@dataclass(frozen=True)
class Reached:
    """Where a descent ended."""

    theta: Array
    starts: list[Array]
    at: Linearised
    rounds: int


def descent(
    problem: Problem,
    hypothesis: Hypothesis,
    begin: tuple[Array, list[Array]],
    bounds: tuple[Array, Array],
    precision: Array,
    rounds: int,
    enough: float,
) -> Reached:
    """Levenberg-Marquardt within bounds, from coordinates and starts."""
    coordinates = hypothesis.coordinates()
    lower, upper = bounds
    theta, starts = np.clip(begin[0], lower, upper), begin[1]
    at = problem.linearised(hypothesis, theta, starts)
    damping, refusals, done = 1e-6, 0, 0
    while done < rounds:
        done += 1
        matrix, gradient = reduced(at.normals)
        matrix = matrix + np.diag(precision)
        gradient = gradient - precision * theta
        damped = matrix + damping * np.diag(np.maximum(np.diag(matrix), 1e-12))
        step = box_step(damped, gradient, lower - theta, upper - theta)
        step = _limited(step, coordinates)
        tried_theta = [theta + share * step for share in TRIALS]
        tried_starts = [
            np.stack([start + start_step(n, share * step) for share in TRIALS])
            for start, n in zip(starts, at.normals, strict=True)
        ]
        found = problem.costs([hypothesis.packed(t) for t in tried_theta], tried_starts)
        totals = found + np.array([float(precision @ t**2) for t in tried_theta])
        best = int(np.argmin(totals))
        gain = at.cost + float(precision @ theta**2) - float(totals[best])
        if gain <= 0.0 or not np.isfinite(gain):
            refusals += 1
            damping = max(damping * 30.0, 1e-3)
            if refusals > MOST_REFUSALS or float(step @ matrix @ step) < enough:
                break
            continue
        theta = tried_theta[best]
        starts = [s[best] for s in tried_starts]
        damping = damping / 10.0 if best == 0 else damping * 3.0
        at = problem.linearised(hypothesis, theta, starts)
        if gain < enough:
            break
    return Reached(theta, starts, at, done)


def _limited(step: Array, coordinates: tuple[Coordinate, ...]) -> Array:
    """No logarithmic coordinate moves by more than a factor of two at once."""
    largest = max((abs(s) for s, c in zip(step, coordinates, strict=True) if c.scale == "log"), default=0.0)
    return step * min(1.0, 0.7 / largest) if largest > 0.0 else step
