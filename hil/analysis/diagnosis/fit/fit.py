"""A hypothesis at its best: the smallest simulation error that its numbers and initial values reach."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis, key_of
from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.least_squares import Hopeless, Reached, descent
from hil.analysis.diagnosis.fit.normal import reduced
from hil.analysis.diagnosis.fit.problem import Linearised, Problem
from hil.analysis.diagnosis.fit.thresholds import MOST_ROUNDS, POLISHED, SAME_COST, WORTH_A_LEAP
from hil.analysis.diagnosis.fit.whole_samples import delay_by_samples

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit:
    """A hypothesis at its best: `cost` is the sum of squared weighted errors (1 per row for pure noise).

    `covariance` holds for white errors of the size of the noise: see `standard_errors`.

    `angles` are those that its ripples, if any, follow.
    """

    hypothesis: Hypothesis
    theta: Array
    starts: list[Array]
    cost: float
    prior: float
    covariance: Array
    errors: tuple[Errors, ...] = field(repr=False)
    rounds: int = 0
    angles: tuple[Array, ...] = field(default=(), repr=False)
    #: Standard errors of the coordinates where other weights than those of `cost` led to them.
    standard: Array | None = field(default=None, repr=False)
    #: How far the coordinates of fits that are as good lie from these.
    scatter: Array | None = field(default=None, repr=False)

    @property
    def rows(self) -> int:
        """How many errors there are, at least 1."""
        return max(1, sum(len(errors.rows) for errors in self.errors))

    @property
    def white_errors(self) -> Array:
        """Standard errors of the coordinates for white errors as large as those that are left."""
        left = max(1.0, self.cost / self.rows)
        return np.asarray(np.sqrt(np.maximum(np.diag(self.covariance) * left, 0.0)))

    @property
    def total(self) -> float:
        """Cost with the price of parameter corrections."""
        return self.cost + self.prior


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    starts: list[Array] | None = None,
    theta: Array | None = None,
    *,
    rounds: int = MOST_ROUNDS,
    enough: float = 1.0,
    at: Linearised | None = None,
    hopeless: Hopeless | None = None,
) -> Fit:
    """Minimise the simulation error of `hypothesis` from `theta` and `starts`.

    Args:
        enough: stop when a step gains less than this in the sum of squared errors.
        at: the problem at `theta` and `starts`, where it is known already.
        hopeless: when to give up.
    """
    lower, upper = bounds_of(hypothesis)
    theta = np.clip(hypothesis.start() if theta is None else theta, lower, upper)
    starts = [s.copy() for s in (starts or problem.first_starts())]
    precision = precision_of(problem, hypothesis)
    by_samples = delay_by_samples(hypothesis, problem.traces[0].dt) if rounds else None
    done, reached = 0, None
    while True:
        within = lower, upper
        if by_samples is not None:
            tried = [theta, *by_samples.leaps(theta, lower, upper)]
            leapt = cheapest(problem, hypothesis, tried, starts, precision, lead=WORTH_A_LEAP)
            if reached is not None and leapt is theta:
                break
            theta, at = leapt, at if leapt is theta else None
            within = by_samples.within(theta, lower, upper)
        begin = theta, starts
        reached = descent(problem, hypothesis, begin, within, precision, rounds - done, enough, at, hopeless)
        theta, starts, done = reached.theta, reached.starts, done + reached.rounds
        if by_samples is None or done >= rounds:
            break
    if by_samples is not None and done < rounds:
        for other in by_samples.beside_bend(theta, lower, upper):
            begin = other, starts
            tried_too = descent(problem, hypothesis, begin, (lower, upper), precision, rounds - done, enough)
            if _total(tried_too, precision) < _total(reached, precision):
                reached = tried_too
        theta, starts, done = reached.theta, reached.starts, max(done, reached.rounds)
    matrix, _ = reduced(reached.at.normals)
    covariance = _inverse(matrix + np.diag(precision))
    prior = float(precision @ theta**2) + (by_samples.coincidence(theta) if by_samples is not None else 0.0)
    return Fit(
        hypothesis,
        theta,
        starts,
        reached.at.cost,
        prior,
        covariance,
        reached.at.errors,
        done,
        problem.angles,
    )


def _total(reached: Reached, precision: Array) -> float:
    return reached.at.cost + float(precision @ reached.theta**2)


def fitted_on(problem: Problem, one: Fit, *, rounds: int = MOST_ROUNDS, enough: float = 1.0) -> Fit:
    """`one`, a fit of this very problem that ended early, taken on from where it is."""
    at = Linearised(one.cost, problem.normals(one.errors, one.starts), one.errors)
    return fit(problem, one.hypothesis, one.starts, one.theta, rounds=rounds, enough=enough, at=at)


def polished(problem: Problem, one: Fit) -> Fit:
    """A fit that ended early, being one of many, taken on to where a step gains next to nothing."""
    further = fit(problem, one.hypothesis, one.starts, one.theta, enough=POLISHED)
    return replace(further, scatter=one.scatter) if further.total < one.total else one


def cheapest(
    problem: Problem,
    hypothesis: Hypothesis,
    tried: list[Array],
    starts: list[Array],
    precision: Array | float = 0.0,
    *,
    lead: float = 0.0,
    inert: float = np.inf,
) -> Array:
    """Those of the coordinates `tried` that leave the smallest error, unfitted.

    Args:
        lead: what the others must gain over the first in the sum of squared errors.
        inert: that sum where nothing has changed yet: from there no slope leads anywhere.
    """
    each = [np.tile(start, (len(tried), 1)) for start in starts]
    costs = problem.costs([hypothesis.packed(theta) for theta in tried], each)
    costs += np.array([np.sum(precision * theta**2) for theta in tried])
    costs[0] -= lead
    acts = ~np.isclose(costs, inert, rtol=SAME_COST, atol=0.0)
    if acts.any():
        costs[~acts] = np.inf
    return tried[int(np.argmin(costs))]


def started_from(parent: Fit, hypothesis: Hypothesis) -> Array:
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


def _inverse(matrix: Array) -> Array:
    """Pseudo-inverse of normal equations, each number in its own unit.

    Numbers of 1e5 N m/rad³ and of 1e-4 s stand side by side: taken as they are, the cut that leaves out what
    nothing tells would leave out what is stated in large units, as if it were known exactly.
    """
    scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    even = np.linalg.pinv(matrix * np.outer(scale, scale), hermitian=True)
    return np.asarray(even * np.outer(scale, scale), dtype=float)


def bounds_of(hypothesis: Hypothesis) -> tuple[Array, Array]:
    """Lower and upper bounds of the coordinates."""
    coordinates = hypothesis.coordinates()
    return np.array([c.lower for c in coordinates]), np.array([c.upper for c in coordinates])


def precision_of(problem: Problem, hypothesis: Hypothesis) -> Array:
    """How firmly what is known beforehand holds the coordinates, in squared errors."""
    return np.array([problem.misfit / c.prior**2 for c in hypothesis.coordinates()])
