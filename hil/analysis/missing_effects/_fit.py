"""The one optimiser: bounded least squares on weighed errors, starts of recordings projected out.

Starts (speeds, shaft torque) act nearly linearly, so they are eliminated in closed form and the fit sees the
numbers alone (G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; L. Kaufman's derivatives, BIT 15
(1975) 49). The rest is Levenberg and Marquardt's method with derivatives by finite differences of one batch
simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._hypothesis import Coordinate, Hypothesis
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._spectrum import Powers
from hil.core.model import Model

Array = npt.NDArray[np.float64]

_START_ROUNDS = 3
_DAMPING = 1e-3  # of the normal equations' diagonal, at first
_SETTLED = 1e-5  # of the cost: a step that brings less is the last one
ENOUGH = 3e-4
"""The same in a round whose weights are not the last ones."""
_SMALLEST = 1e-6  # step of a coordinate
_FAILED = 3  # steps in a row, after which slopes are taken anew
_ABRUPT = (30.0, 1.0)  # differences where contact comes and goes: over small ones the misfit jumps
ROUNDS = 6
"""Of a fit at most, each with the weights that the one before left."""
EVALUATIONS = 12  # of a round: the next one has better starts and weights


class Descent(Protocol):
    """What a least-squares fit needs."""

    def residual(self, u: Array) -> Array:
        """Numbers whose squares are to be least."""
        ...

    def jacobian(self, u: Array, wider: float = 1.0) -> Array:
        """Their derivatives, numbers x coordinates, over so many times the usual differences."""
        ...


@dataclass(frozen=True)
class Point:
    """A hypothesis at some numbers, its start of each recording (5,) and errors of each (blocks x 3)."""

    hypothesis: Hypothesis
    starts: tuple[Array, ...]
    errors: tuple[Array, ...]

    def powers(self, problem: Problem) -> Powers:
        """Of the errors."""
        return problem.powers(self.errors)


@dataclass(frozen=True)
class Linearised:
    """Weighed errors `left` (numbers,) and `slopes` (numbers x coordinates), without the starts' part.

    Behind them stands the prior, with slopes as if the base's numbers could all be had back.
    `bases` are the starts' directions of each recording; `covariance` is that of the coordinates, by the
    spectrum of the problem, so that it holds the misfit with its colour.
    """

    point: Point
    coordinates: tuple[Coordinate, ...]
    left: Array
    slopes: Array
    covariance: Array
    bases: tuple[Array, ...]

    def standard_error(self, term: int, name: str) -> float:
        """Of a number, in its unit; NaN where it is not free."""
        for index, one in enumerate(self.coordinates):
            if one.term == term and one.name == name:
                return float(abs(one.slope(0.0)) * np.sqrt(max(self.covariance[index, index], 0.0)))
        return float("nan")

    def holding(self, held: Sequence[bool]) -> Linearised:
        """The same, some coordinates held."""
        free = ~np.array(held, dtype=bool)
        slopes = self.slopes[:, free]
        coordinates = tuple(one for one, is_free in zip(self.coordinates, free, strict=True) if is_free)
        covariance = np.asarray(np.linalg.pinv(slopes.T @ slopes, hermitian=True), dtype=float)
        return replace(self, coordinates=coordinates, slopes=slopes, covariance=covariance)

    def drawn(self, count: int) -> tuple[Model, ...]:
        """Models that the data allow as well, by the covariance of the numbers; the same ones every time."""
        if not self.coordinates:
            return ()
        moves = np.clip(likely_moves(self.covariance, count), *bounds_of(self.coordinates))
        return tuple(self.point.hypothesis.moved(self.coordinates, move).model() for move in moves)


def likely_moves(covariance: Array, count: int) -> Array:
    """Draws around what was found, (count, numbers), by the covariance; the same ones every time."""
    values, axes = np.linalg.eigh(covariance)
    normal = np.random.default_rng(0).standard_normal((count, len(values)))
    return np.asarray(normal * np.sqrt(np.maximum(values, 0.0)) @ axes.T)


def point_at(problem: Problem, hypothesis: Hypothesis, starts: Sequence[Array] | None = None) -> Point:
    """A hypothesis as it is, from given starts or from a first guess of them."""
    states = tuple(starts or problem.first_states())
    return Point(hypothesis, states, tuple(problem.errors(hypothesis, states)))


def with_better_starts(problem: Problem, point: Point) -> Point:
    """The same hypothesis from the starts that suit the data best."""
    for _ in range(_START_ROUNDS):
        directions = _directions(problem, point.hypothesis, point.starts)
        better = _better_starts(problem, point.hypothesis, point.starts, directions)
        point = point_at(problem, point.hypothesis, better)
    return point


def fit(
    problem: Problem, point: Point, held: frozenset[str] = frozenset(), evaluations: int = EVALUATIONS
) -> Point:
    """One round: all numbers by least squares while the starts' directions stay, then the starts.

    A number that moves by its logarithm goes by a factor e at most: from next to nothing, where early weights
    may send it, no slope would lead it back.

    Args:
        held: numbers that stay what they are.
    """
    hypothesis = point.hypothesis
    coordinates = [one for one in problem.coordinates(hypothesis) if one.name not in held]
    if not coordinates:
        return with_better_starts(problem, point)
    round_ = _Round(problem, hypothesis, point.starts, coordinates)
    found = least_squares(round_, *bounds_of(coordinates, 1.0), evaluations, _differences(hypothesis), ENOUGH)
    hypothesis = hypothesis.moved(coordinates, found)
    return point_at(problem, hypothesis, _better_starts(problem, hypothesis, point.starts, round_.directions))


def least_squares(
    round_: Descent,
    lower: Array,
    upper: Array,
    evaluations: int,
    differences: Sequence[float] = (1.0,),
    settled: float = _SETTLED,
) -> Array:
    """Coordinates that leave least of a round's residual within bounds, from zero.

    Levenberg and Marquardt's steps (D. Marquardt, J. SIAM 11 (1963) 431); a coordinate at a bound that the
    slope pushes outwards stays there. Normal equations take a tenth of the time of a decomposition of the
    tall Jacobian, and what they lose in digits the next step has again.

    Args:
        differences: by which slopes are taken, times the usual ones; the next where steps fail.
        settled: share of the cost; a step that brings less is the last one.
    """
    u = np.zeros(len(lower))
    left = round_.residual(u)
    cost, damping = float(left @ left), _DAMPING
    wider, *narrower = differences
    here, failed = False, 0
    for _ in range(evaluations - 1):
        if not here:
            slopes = round_.jacobian(u, wider)
            gradient, normal = slopes.T @ left, slopes.T @ slopes
        free = ~(((u <= lower) & (gradient > 0.0)) | ((u >= upper) & (gradient < 0.0)))
        if not free.any():
            break
        scale = np.maximum(np.diag(normal), 1e-12 * max(float(np.max(np.diag(normal))), 1e-300))
        damped = (normal + np.diag(damping * scale))[np.ix_(free, free)]
        step = np.zeros(len(u))
        step[free] = -np.linalg.lstsq(damped, gradient[free], rcond=None)[0]
        trial = np.clip(u + step, lower, upper)
        moved = round_.residual(trial)
        had, cost_there = cost, float(moved @ moved)
        here = not cost_there < cost
        ends = np.max(np.abs(trial - u)) < _SMALLEST
        if not here:
            u, left, cost, damping, failed = trial, moved, cost_there, 0.1 * damping, 0
            ends = had - cost < settled * had
        else:
            damping, failed = 10.0 * damping, failed + 1
        if narrower and (ends or failed == _FAILED):
            wider, damping, here, failed = narrower.pop(0), _DAMPING, False, 0
        elif ends:
            break
    return u


def linearised(problem: Problem, point: Point, *, free: bool = True) -> Linearised:
    """Errors and their derivatives at a point; where numbers are not `free`, by starts alone.

    Beside an abrupt effect over the widest differences: jumps of the misfit would pass for knowledge.
    """
    coordinates = problem.coordinates(point.hypothesis) if free else []
    round_ = _Round(problem, point.hypothesis, point.starts, coordinates)
    zero = np.zeros(len(coordinates))
    left, slopes = round_.residual(zero), round_.jacobian(zero, _differences(point.hypothesis)[0])
    covariance: Array = np.asarray(np.linalg.pinv(slopes.T @ slopes, hermitian=True), dtype=float)
    if coordinates:
        slopes[-len(coordinates) :] = problem.prior_chords(coordinates, zero)
    return Linearised(point, tuple(coordinates), left, slopes, covariance, tuple(round_.bases))


def _differences(hypothesis: Hypothesis) -> tuple[float, ...]:
    """Times the usual ones, by which slopes are taken, widest first."""
    return _ABRUPT if hypothesis.is_abrupt else (1.0,)


def bounds_of(coordinates: Sequence[Coordinate], most: float = np.inf) -> tuple[Array, Array]:
    """Lowest and highest value of each coordinate; logarithms go by `most` at most."""
    lower = np.array([one.of(one.lower) if one.lower > -np.inf else -np.inf for one in coordinates])
    upper = np.array([one.of(one.upper) if one.upper < np.inf else np.inf for one in coordinates])
    reach = np.array([most if one.logarithmic else np.inf for one in coordinates])
    return np.clip(lower, -reach, -1e-9), np.clip(upper, 1e-9, reach)


class _Round:
    """Residual and derivatives while the starts' directions stay what they are."""

    def __init__(
        self,
        problem: Problem,
        hypothesis: Hypothesis,
        states: Sequence[Array],
        coordinates: Sequence[Coordinate],
    ) -> None:
        self.problem, self.hypothesis = problem, hypothesis
        self.states, self.coordinates = states, coordinates
        self.directions = _directions(problem, hypothesis, states)
        self.bases = [basis for _, basis in self.directions]

    def residual(self, u: Array) -> Array:
        packed = [self.hypothesis.moved(self.coordinates, u).packed()]

        def left(index: int) -> Array:
            shown = self.problem.simulated(index, packed, self.states[index][None])
            error = self.problem.weighed(index, self.problem.series[index].measured - shown)[0]
            return without(self.bases[index], error)

        return np.concatenate([*self.problem.each(left), self.problem.prior(self.coordinates, u)])

    def jacobian(self, u: Array, wider: float = 1.0) -> Array:
        slopes = self.problem.derivatives(self.hypothesis, self.states, self.coordinates, u, wider)
        parts = self.problem.each(lambda index: without(self.bases[index], slopes[index]))
        prior = self.problem.prior_slopes(self.coordinates, u)
        columns = prior.reshape(len(self.coordinates), len(self.coordinates)).T  # in memory as the parts are
        return np.concatenate([*parts, columns])


def without(basis: Array, values: Array) -> Array:
    """What is left of values (numbers, or numbers x k) beside an orthonormal basis, in their place."""
    rows = values.T
    rows -= (rows @ basis) @ basis.T
    return values


def _directions(
    problem: Problem, hypothesis: Hypothesis, states: Sequence[Array]
) -> list[tuple[Array, Array]]:
    """In which errors change with each recording's start (`Problem.start_basis`)."""
    return problem.each(lambda index: problem.start_basis(index, hypothesis, states[index]))


def _better_starts(
    problem: Problem,
    hypothesis: Hypothesis,
    states: Sequence[Array],
    directions: Sequence[tuple[Array, Array]],
) -> list[Array]:
    """Starts that suit the data best, to first order, by the errors' change along their directions."""
    packed = [hypothesis.packed()]

    def errors(index: int, start: Array) -> Array:
        shown = problem.simulated(index, packed, start[None])
        return np.asarray(problem.weighed(index, problem.series[index].measured - shown)[0])

    def better(index: int) -> Array:
        moves, basis = directions[index]
        error = errors(index, states[index])
        moved = states[index] + moves @ (basis.T @ error)
        again = errors(index, moved)
        return moved if again @ again <= error @ error else states[index]

    return problem.each(better)
