"""The one optimiser: bounded least squares on weighed errors, starts of recordings projected out.

Starts (speeds, shaft torque) act nearly linearly, so they are eliminated in closed form and the fit sees the
numbers alone (G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; L. Kaufman's derivatives, BIT 15
(1975) 49). The rest is scipy's trust-region reflective method (M. Branch, T. Coleman, Y. Li, SIAM J. Sci.
Comput. 21 (1999) 1) with derivatives by finite differences of one batch simulation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._hypothesis import Coordinate, Hypothesis
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._spectrum import Powers, powers_of

Array = npt.NDArray[np.float64]

_START_ROUNDS = 3
EVALUATIONS = 12  # of a round: the next one has better starts and weights


@dataclass(frozen=True)
class Point:
    """A hypothesis at some numbers, its start of each recording (5,) and errors of each (blocks x 3)."""

    hypothesis: Hypothesis
    starts: tuple[Array, ...]
    errors: tuple[Array, ...]

    def powers(self, problem: Problem) -> Powers:
        """Of the errors."""
        return powers_of(self.errors, problem.rate_hz, problem.signal)


@dataclass(frozen=True)
class Linearised:
    """Weighed errors `left` (numbers,) and `slopes` (numbers x coordinates), without the starts' part.

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


def point_at(problem: Problem, hypothesis: Hypothesis, starts: Sequence[Array] | None = None) -> Point:
    """A hypothesis as it is, from given starts or from a first guess of them."""
    states = tuple(starts or problem.first_states())
    return Point(hypothesis, states, tuple(problem.errors(hypothesis, states)))


def with_better_starts(problem: Problem, point: Point) -> Point:
    """The same hypothesis from the starts that suit the data best."""
    for _ in range(_START_ROUNDS):
        point = point_at(problem, point.hypothesis, _better_starts(problem, point.hypothesis, point.starts))
    return point


def fit(
    problem: Problem, point: Point, held: frozenset[str] = frozenset(), evaluations: int = EVALUATIONS
) -> Point:
    """One round: all numbers by least squares while the starts' directions stay, then the starts.

    Args:
        held: numbers of the base that stay what they are.
    """
    from scipy.optimize import least_squares

    hypothesis = point.hypothesis
    coordinates = [one for one in problem.coordinates(hypothesis) if one.term >= 0 or one.name not in held]
    round_ = _Round(problem, hypothesis, point.starts, coordinates)
    lower, upper = _bounds(coordinates)
    found = least_squares(
        round_.residual,
        np.zeros(len(coordinates)),
        round_.jacobian,
        (lower, upper),
        x_scale="jac",
        ftol=1e-5,
        xtol=1e-6,
        gtol=1e-9,
        max_nfev=evaluations,
    )
    hypothesis = hypothesis.moved(coordinates, found.x)
    return point_at(problem, hypothesis, _better_starts(problem, hypothesis, point.starts))


def linearised(problem: Problem, point: Point, *, free: bool = True) -> Linearised:
    """Errors and their derivatives at a point; where numbers are not `free`, by starts alone."""
    coordinates = problem.coordinates(point.hypothesis) if free else []
    round_ = _Round(problem, point.hypothesis, point.starts, coordinates)
    zero = np.zeros(len(coordinates))
    left, slopes = round_.residual(zero), round_.jacobian(zero)
    covariance: Array = np.asarray(np.linalg.pinv(slopes.T @ slopes, hermitian=True), dtype=float)
    data = len(left) - len(coordinates)  # behind it stands the prior
    return Linearised(point, tuple(coordinates), left[:data], slopes[:data], covariance, tuple(round_.bases))


def _bounds(coordinates: Sequence[Coordinate]) -> tuple[Array, Array]:
    lower = np.array([one.of(one.lower) if one.lower > -np.inf else -np.inf for one in coordinates])
    upper = np.array([one.of(one.upper) if one.upper < np.inf else np.inf for one in coordinates])
    return np.minimum(lower, -1e-9), np.maximum(upper, 1e-9)


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
        self.bases = [problem.start_basis(i, hypothesis, s)[2] for i, s in enumerate(states)]

    def residual(self, u: Array) -> Array:
        packed = [self.hypothesis.moved(self.coordinates, u).packed()]
        parts = []
        for index, state in enumerate(self.states):
            shown = self.problem.simulated(index, packed, state[None])
            error = self.problem.weighed(index, self.problem.series[index].measured - shown)[0]
            parts.append(without(self.bases[index], error))
        return np.concatenate([*parts, self.problem.prior(self.coordinates, u)])

    def jacobian(self, u: Array) -> Array:
        parts = []
        for index, state in enumerate(self.states):
            _, slopes = self.problem.derivatives(index, self.hypothesis, state, self.coordinates, u)
            parts.append(without(self.bases[index], slopes))
        prior = self.problem.prior_slopes(self.coordinates)
        return np.concatenate([*parts, prior.reshape(len(self.coordinates), len(self.coordinates))])


def without(basis: Array, values: Array) -> Array:
    """What is left of values (numbers, or numbers x k) beside an orthonormal basis."""
    return np.asarray(values - basis @ (basis.T @ values))


def _better_starts(problem: Problem, hypothesis: Hypothesis, states: Sequence[Array]) -> list[Array]:
    """Starts that suit the data best, to first order."""
    better = []
    for index, state in enumerate(states):
        change, sizes, _ = problem.start_basis(index, hypothesis, state)
        shown = problem.simulated(index, [hypothesis.packed()], state[None])
        error = problem.weighed(index, problem.series[index].measured - shown)[0]
        moves = np.linalg.lstsq(change, error, rcond=1e-7)[0]
        moved = state + sizes * moves
        shown = problem.simulated(index, [hypothesis.packed()], moved[None])
        again = problem.weighed(index, problem.series[index].measured - shown)[0]
        better.append(moved if again @ again <= error @ error else state)
    return better
