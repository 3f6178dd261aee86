"""Linearised score of every effect against the remaining error, parameters and starts projected out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis, key_of
from hil.analysis.diagnosis.fit.fit import Fit, bounds_of, precision_of, started_from
from hil.analysis.diagnosis.fit.least_squares import box_step
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.whole_samples import delay_by_samples
from hil.analysis.diagnosis.search.probes import Candidate, mismatches, probes
from hil.analysis.diagnosis.search.thresholds import LOOKED_AT_CLOSELY, PROBE_DIVERGED, SCORED_MISMATCH
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Score:
    """An effect at its most promising size; `gain` is the expected drop of the sum of squared errors.

    `place` is that of its probe.
    """

    use: EffectUse
    gain: float
    place: int = 0

    @property
    def key(self) -> tuple[str, str]:
        """Id and channel or parameter."""
        return key_of(self.use)


def screen(problem: Problem, fit: Fit, against: float | None = None) -> list[Score]:
    """Every effect that can be added to `fit`, each at its best probe, most promising first.

    Gains count from the total `against`; from what the parameters alone can reach if None.
    """
    candidates = probes(problem, fit)
    best = _scored(problem, fit, [c for c in candidates if c.probe.first], against)
    if near := _near(best, candidates):
        for score in _scored(problem, fit, near, against).values():
            _keep(best, score)
    return sorted(best.values(), key=lambda s: -s.gain)


def _near(best: Mapping[tuple[str, str], Score], candidates: Sequence[Candidate]) -> list[Candidate]:
    """Probes that are not looked at first, beside the best of those that promise something."""
    least = LOOKED_AT_CLOSELY * max((score.gain for score in best.values()), default=0.0)
    places = {score.key: score.place for score in best.values() if score.gain > least}
    return [
        c for c in candidates if not c.probe.first and abs(c.probe.place - places.get(c.key, np.inf)) <= 1
    ]


def _scored(
    problem: Problem, fit: Fit, candidates: list[Candidate], against: float | None
) -> dict[tuple[str, str], Score]:
    """Every effect at the best of these probes, and every parameter that may be wrong."""
    errors = {index: one.rows[:, None] for index, one in enumerate(fit.errors)}
    matrix, gradients = products(problem, fit, candidates, errors)
    gradient = gradients[:, 0]
    base = len(fit.theta)
    lower, upper = (bound - fit.theta for bound in _bounds(problem, fit))
    precision = precision_of(problem, fit.hypothesis)
    matrix[:base, :base] += np.diag(precision)
    gradient[:base] -= precision * fit.theta
    rest = _gain(matrix, gradient, lower, upper, np.arange(base))[0]
    if against is not None:
        rest = fit.total - against
    best: dict[tuple[str, str], Score] = {}
    for probe, columns in probe_columns(candidates, base):
        low = np.concatenate([lower, [d.lower for d in probe.directions]])
        high = np.concatenate([upper, [d.upper for d in probe.directions]])
        gain, amounts = _gain(matrix, gradient, low, high, columns)
        _keep(best, Score(probe.use(amounts[base:].tolist()), gain - rest, probe.probe.place))
    for use, index in mismatch_columns(fit.hypothesis):
        low, high = lower.copy(), upper.copy()
        low[index], high[index] = -SCORED_MISMATCH, SCORED_MISMATCH
        freed = matrix.copy()
        freed[index, index] -= precision[index]
        pull = gradient.copy()
        pull[index] += precision[index] * fit.theta[index]
        gain, step = _gain(freed, pull, low, high, np.arange(base))
        value = float(use.values["value"]) * float(np.exp(fit.theta[index] + step[index]))
        _keep(best, Score(EffectUse(use.id, {**use.values, "value": value}), gain - rest))
    return best


def _bounds(problem: Problem, fit: Fit) -> tuple[Array, Array]:
    """Of the coordinates: a dead time that jumps by samples has no slope beyond its own.

    At the edge of a sample its derivative holds the jump, as if a part of it could be had: what a lag, or a
    late channel, explains would seem to be explained by that.
    """
    lower, upper = bounds_of(fit.hypothesis)
    by_samples = delay_by_samples(fit.hypothesis, problem.traces[0].dt)
    return (lower, upper) if by_samples is None else by_samples.within(fit.theta, lower, upper)


def _keep(best: dict[tuple[str, str], Score], score: Score) -> None:
    if score.key not in best or best[score.key].gain < score.gain:
        best[score.key] = score


def probe_columns(
    candidates: Sequence[Candidate], base: int
) -> Iterator[tuple[Candidate, npt.NDArray[np.int_]]]:
    """Every probe with the columns of `products` that it may use: the `base` first, and its directions."""
    at = base
    for probe in candidates:
        yield probe, np.concatenate([np.arange(base), np.arange(at, at + len(probe.directions))])
        at += len(probe.directions)


def mismatch_columns(hypothesis: Hypothesis) -> Iterator[tuple[EffectUse, int]]:
    """Every parameter that may be wrong, with the column that is then held no longer."""
    names = [c.name if c.term < 0 else "" for c in hypothesis.coordinates()]
    for use in mismatches(hypothesis):
        yield use, names.index(str(use.values["parameter"]))


def _gain(
    matrix: Array, gradient: Array, lower: Array, upper: Array, columns: npt.NDArray[np.int_]
) -> tuple[float, Array]:
    """Drop of the squared error that `columns` can buy within their bounds, and their amounts."""
    m, g = matrix[np.ix_(columns, columns)], gradient[columns]
    x = box_step(m, g, lower, upper)
    return float(2 * g @ x - x @ m @ x), x


def products(
    problem: Problem, fit: Fit, candidates: list[Candidate], errors: Mapping[int, Array]
) -> tuple[Array, Array]:
    """Products of all derivatives and probe responses with each other and with errors, starts projected out.

    Products between different probes are left zero: no two are used together.

    Args:
        errors: rows x as many as there are to compare with, of each recording that takes part.
    """
    packed = [fit.hypothesis.packed(fit.theta)]
    for probe in candidates:
        for direction in probe.directions:
            added = fit.hypothesis.with_term(probe.along(direction))
            packed.append(added.packed(started_from(fit, added)))
    slots = np.stack([p for p, _ in packed])
    sensors = np.stack([s for _, s in packed])
    base, size = len(fit.theta), len(fit.theta) + len(packed) - 1
    groups = np.cumsum([0, *(len(p.directions) for p in candidates)])
    matrix = np.zeros((size, size))
    gradient = np.zeros((size, next(iter(errors.values())).shape[1]))
    for index, error in errors.items():
        shared, initial = fit.errors[index].by_coordinate, fit.errors[index].by_start
        starts = np.tile(fit.starts[index], (len(packed), 1))
        simulated = problem.outputs(index, slots, sensors, starts)
        change = problem.changes(index, simulated).reshape(len(packed) - 1, -1)
        diverged = ~(np.abs(change).max(axis=1) < PROBE_DIVERGED)
        change[diverged] = 0.0
        basis = np.linalg.qr(initial)[0] if np.any(initial) else np.zeros((len(error), 1))
        mine = shared - basis @ (basis.T @ shared)
        free = error - basis @ (basis.T @ error)
        along = change @ basis
        matrix[:base, :base] += mine.T @ mine
        across = change @ mine
        matrix[base:, :base] += across
        matrix[:base, base:] += across.T
        gradient[:base] += mine.T @ free
        gradient[base:] += change @ free
        for first, last in pairwise(groups.tolist()):
            own = change[first:last] @ change[first:last].T - along[first:last] @ along[first:last].T
            matrix[base + first : base + last, base + first : base + last] += own
    return matrix, gradient
