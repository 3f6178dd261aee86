"""The one optimiser: bounded least squares on weighed errors, starts of recordings projected out.

Starts (speeds, shaft torque) act nearly linearly, so they are eliminated in closed form and the fit sees the
numbers alone (G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; L. Kaufman's derivatives, BIT 15 (1975)
49). The rest is scipy's trust-region reflective method (M. Branch, T. Coleman, Y. Li, SIAM J. Sci. Comput. 21
(1999) 1) with derivatives by finite differences of one batch simulation.
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

_ROUNDS = 4  # of fits, each with the starts that the one before found
_SETTLED = 1e-3  # relative change of the cost between rounds that ends them
_EVALUATIONS = 25


@dataclass(frozen=True)
class Fitted:
    """A hypothesis with the numbers that suit the data best.

    `errors` are those of each recording (blocks x 3); `covariance` is that of `coordinates` at 0, misfit
    included; `sensitivities` (numbers x coordinates) and `left` (numbers,) are weighed, starts projected out.
    """

    hypothesis: Hypothesis
    starts: tuple[Array, ...]
    errors: tuple[Array, ...]
    cost: float
    coordinates: tuple[Coordinate, ...]
    covariance: Array
    sensitivities: Array
    left: Array
    bases: tuple[Array, ...]

    def powers(self, problem: Problem) -> Powers:
        """Of the errors."""
        return powers_of(self.errors, problem.rate_hz)

    def standard_error(self, term: int, name: str) -> float:
        """Of a number; NaN where it was not fitted."""
        for index, one in enumerate(self.coordinates):
            if one.term == term and one.name == name:
                return float(abs(one.slope(0.0)) * np.sqrt(max(self.covariance[index, index], 0.0)))
        return float("nan")


def fit(
    problem: Problem, hypothesis: Hypothesis, starts: Sequence[Array] | None = None, evaluations: int = _EVALUATIONS
) -> Fitted:
    """Fit all numbers of a hypothesis from the values that it has."""
    from scipy.optimize import least_squares

    states = [one.copy() for one in (starts or problem.first_states())]
    before = np.inf
    for _ in range(_ROUNDS):
        coordinates = hypothesis.coordinates(problem.scales)
        round_ = _Round(problem, hypothesis, states, coordinates)
        lower, upper = _bounds(coordinates)
        found = least_squares(
            round_.residual,
            np.clip(np.zeros(len(coordinates)), lower, upper),
            round_.jacobian,
            (lower, upper),
            x_scale="jac",
            ftol=1e-6,
            xtol=1e-7,
            gtol=1e-9,
            max_nfev=evaluations,
        )
        hypothesis = hypothesis.moved(coordinates, found.x)
        states = _better_starts(problem, hypothesis, states)
        if before - found.cost < _SETTLED * found.cost:
            break
        before = float(found.cost)
    return _finished(problem, hypothesis, states)


def _bounds(coordinates: Sequence[Coordinate]) -> tuple[Array, Array]:
    lower = np.array([one.of(one.lower) if one.lower > -np.inf else -np.inf for one in coordinates])
    upper = np.array([one.of(one.upper) if one.upper < np.inf else np.inf for one in coordinates])
    return np.minimum(lower, -1e-9), np.maximum(upper, 1e-9)


class _Round:
    """Residual and derivatives while the starts' directions stay what they are."""

    def __init__(
        self, problem: Problem, hypothesis: Hypothesis, states: Sequence[Array], coordinates: Sequence[Coordinate]
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
        return np.concatenate([*parts, self.problem.prior_slopes(self.coordinates)])


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


def _finished(problem: Problem, hypothesis: Hypothesis, states: Sequence[Array]) -> Fitted:
    coordinates = hypothesis.coordinates(problem.scales)
    round_ = _Round(problem, hypothesis, states, coordinates)
    zero = np.zeros(len(coordinates))
    left, slopes = round_.residual(zero), round_.jacobian(zero)
    errors = problem.errors(hypothesis, states)
    prior = len(coordinates)
    return Fitted(
        hypothesis,
        tuple(states),
        tuple(errors),
        0.5 * float(left @ left),
        tuple(coordinates),
        np.linalg.pinv(slopes.T @ slopes, hermitian=True),
        slopes[: len(slopes) - prior],
        left[: len(left) - prior],
        tuple(round_.bases),
    )
