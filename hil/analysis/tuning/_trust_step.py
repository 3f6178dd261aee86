"""The best step within a trust region: largest worst margin by linear programs on predicted slopes.

Each round predicts the margins around a point, solves max t, margin_i + slope_i . d >= t within region,
bounds and hard limits (K. Madsen, H. Schjaer-Jacobsen, "Linearly constrained minimax optimization", Math.
Programming 14 (1978) 208), and predicts what that promises: a whole step, half of it, a quarter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import linprog

from hil.analysis.tuning._correction import Correction
from hil.analysis.tuning._parameters import Space
from hil.analysis.tuning._pool import Pool
from hil.analysis.tuning._trial import Tried

Array = npt.NDArray[np.float64]

_ROUNDS = 3
_SHARES = (1.0, 0.5, 0.25)
_SLOPE_STEP = 0.02  # of a parameter's range, at most half of the region
_MEAN_SHARE = 0.01  # of the mean margin: it decides between equals
_WORTH = 1e-4  # a round that promises less is the last


@dataclass(frozen=True)
class Promise:
    """A candidate with its prediction on the model itself, and its margins as runs have corrected them."""

    point: Array
    tried: Tried
    margins: dict[str, float]

    @property
    def worst(self) -> float:
        """The least of them."""
        return min(self.margins.values())

    @property
    def score(self) -> float:
        """The least of them, and a hundredth of their mean."""
        return self.worst + _MEAN_SHARE * float(np.mean(list(self.margins.values())))


class TrustStep:
    """Looks for candidates around a centre; hard limits hold on every car of the trial."""

    def __init__(self, pool: Pool, space: Space, stopped: Callable[[], bool]) -> None:
        self._pool, self._space, self._stopped = pool, space, stopped

    def best(self, centre: Promise, correction: Correction, radius: float) -> Promise:
        """What promises the largest worst margin within `radius`; the centre itself if nothing does."""
        best = centre
        for _ in range(_ROUNDS):
            if self._stopped():
                break
            step = self._step(best, centre.point, correction, radius)
            found = self._kept([best.point + share * step for share in _SHARES], correction)
            if found is None or found.score < best.score + _WORTH:
                break
            best = found
        return best

    def promise(self, point: Array, correction: Correction) -> Promise | None:
        """A candidate on the model itself; None beyond a hard limit."""
        return self._promises([point], correction)[0]

    def _promises(self, points: Sequence[Array], correction: Correction) -> list[Promise | None]:
        tried = self._pool.tried([(self._space.values(point), 0) for point in points])
        return [
            Promise(point, one, _corrected(one, correction.at(point))) if one.feasible else None
            for point, one in zip(points, tried, strict=True)
        ]

    def _kept(self, points: Sequence[Array], correction: Correction) -> Promise | None:
        """The best of them that keeps the hard limits on every car."""
        promises = [one for one in self._promises(points, correction) if one is not None]
        cars = range(1, len(self._pool.trial.draws))
        for one in sorted(promises, key=lambda one: -one.score):
            values = self._space.values(one.point)
            if all(tried.feasible for tried in self._pool.tried([(values, number) for number in cars])):
                return one
        return None

    def _step(self, from_: Promise, centre: Array, correction: Correction, radius: float) -> Array:
        """What a linear program on the slopes at a candidate gives."""
        margins, limits = self._slopes(from_, min(_SLOPE_STEP, 0.5 * radius))
        size, own = from_.point.size, np.array(list(from_.margins.values()))
        margins = margins + correction.slope
        # unknown: d, t; t <= margin_i + slope_i . d, 0 <= limit_j + slope_j . d
        above = np.hstack([-margins, np.ones((len(own), 1))])
        kept = np.hstack([-limits, np.zeros((len(limits), 1))])
        shares = np.array(list(from_.tried.limits.values()))
        low = np.maximum(centre - radius, 0.0) - from_.point
        high = np.minimum(centre + radius, 1.0) - from_.point
        gain: Any = -np.append(_MEAN_SHARE * margins.mean(axis=0), 1.0)
        found = linprog(
            gain,
            A_ub=np.vstack([above, kept]),
            b_ub=np.concatenate([own, shares]),
            bounds=[*zip(low.tolist(), high.tolist(), strict=True), (None, None)],
            method="highs",
        )
        return np.zeros(size) if found.x is None else np.asarray(found.x[:size])

    def _slopes(self, from_: Promise, step: float) -> tuple[Array, Array]:
        """Of predicted margins and of the rooms to the hard limits: a column for each parameter.

        Central differences; from one side where the other is out of bounds or beyond a hard limit.
        """
        ends = []
        for axis in range(from_.point.size):
            for change in (-step, step):
                point = from_.point.copy()
                point[axis] = np.clip(point[axis] + change, 0.0, 1.0)
                ends.append(point)
        tried = self._pool.tried([(self._space.values(point), 0) for point in ends])
        columns = []
        for axis in range(from_.point.size):
            known = [(float(from_.point[axis]), from_.tried)]
            known += [(float(ends[n][axis]), tried[n]) for n in (2 * axis, 2 * axis + 1) if tried[n].margins]
            (first, low), (last, high) = min(known, key=_place), max(known, key=_place)
            columns.append((_numbers(high) - _numbers(low)) / ((last - first) or 1.0))
        slopes = np.column_stack(columns)
        count = len(from_.margins)
        return slopes[:count], slopes[count:]


def _corrected(tried: Tried, correction: Array) -> dict[str, float]:
    return {
        name: margin + more
        for (name, margin), more in zip(tried.margins.items(), correction.tolist(), strict=True)
    }


def _place(known: tuple[float, Tried]) -> float:
    return known[0]


def _numbers(tried: Tried) -> Array:
    return np.array([*tried.margins.values(), *tried.limits.values()])
