"""From a point to the nearest best one, by linear programmes in a trust region.

The least of many margins has a kink where another one becomes the least, and its best value lies at such a
kink: methods that know one number only creep along it. Here every margin and every hard limit is followed by
itself: their slopes come from differences, and the best step within a radius from a linear programme (K.
Madsen, J. Inst. Maths Applics 16 (1975) 321). What is made as large as it can be is the least margin and, for
a twentieth, the mean over the criteria of each one's least over all cars: no point is left for one that is
beaten everywhere, and a little of the worst margin is not bought with much of the others.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.analysis.tuning._trial import MEAN_SHARE, Tried, counted

Array = npt.NDArray[np.float64]
#: What candidates came to on every car that counts, in their order.
TriedOn = Callable[[Sequence[Array]], Sequence[Sequence[Tried]]]

_STEP, _LEAST_STEP = 0.02, 0.004  # of differences, as a share of a parameter's range
_RADII = (1.0, 0.3)  # tried in each round, times the radius
_WIDEST = 0.4
_CUSHION = 0.05  # of a hard limit, that a long step stays off it: it is not as straight as its slope


def score(cars: Sequence[Tried]) -> float:
    """What is searched for: see above; what keeps no hard limit on a car is worse than any margin."""
    if not all(tried.feasible for tried in cars):
        return min(tried.worst for tried in cars)
    least = [counted(min(tried.margins[name] for tried in cars)) for name in cars[0].margins]
    return float(min(least) + MEAN_SHARE * np.mean(least))


def scatter(free: int, count: int, random: np.random.Generator) -> list[Array]:
    """Points all over the unit cube: a scrambled Sobol sequence."""
    from scipy.stats import qmc

    more = math.ceil(math.log2(max(count, 1)))
    return list(qmc.Sobol(free, seed=random).random_base2(more)[:count])


class Ascent:
    """Goes uphill in the unit cube.

    Args:
        tried_on: tries candidates; it sees every one, and may raise to end the ascent.
        criteria, limits: names of margins and hard limits.
    """

    def __init__(self, tried_on: TriedOn, criteria: Sequence[str], limits: Sequence[str]) -> None:
        self._tried_on, self._criteria, self._limits = tried_on, criteria, limits

    def execute(self, start: Array, radius: float, least_radius: float, rounds: int) -> None:
        """From `start` until steps are shorter than `least_radius`.

        A round tries one candidate for each free parameter, and one for each of two radii.
        """
        point = np.clip(start, 0.0, 1.0)
        (cars,) = self._tried_on([point])
        for _ in range(rounds):
            slopes = self._slopes(point, cars, min(_STEP, max(_LEAST_STEP, 0.5 * radius)))
            better = False
            while not better:
                if radius < least_radius:
                    return
                steps = [self._step(point, cars, slopes, share * radius) for share in _RADII]
                points = [np.clip(point + step, 0.0, 1.0) for step in steps]
                found = self._tried_on(points)
                best = int(np.argmax([score(one) for one in found]))
                better = score(found[best]) > score(cars)
                if better:
                    point, cars = points[best], found[best]
                    radius = min(_WIDEST, radius * (2.0, 0.5)[best])
                else:
                    radius *= 0.5 * _RADII[-1]

    def _slopes(self, point: Array, cars: Sequence[Tried], step: float) -> Array:
        """Of all figures, shape (figures, free): from a difference into the cube, else from one out of it."""
        own = self._figures(cars)
        slopes = np.full((len(own), len(point)), np.nan)
        for sign in (1.0, -1.0):
            axes = np.flatnonzero(np.isnan(slopes[np.isfinite(own)]).any(axis=0))
            moves = sign * np.where(point > 0.5, -step, step)
            axes = axes[(point + moves >= 0.0)[axes] & (point + moves <= 1.0)[axes]]
            if len(axes) == 0:
                break
            ends = self._tried_on([point + moves[axis] * np.eye(len(point))[axis] for axis in axes])
            for axis, end in zip(axes, ends, strict=True):
                rise = (self._figures(end) - own) / moves[axis]
                slopes[:, axis] = np.where(np.isnan(rise), slopes[:, axis], rise)
        return np.asarray(np.nan_to_num(slopes))

    def _figures(self, cars: Sequence[Tried]) -> Array:
        """Margins, car by car, then what is left to hard limits; NaN where nothing was run."""
        margins = [counted(tried.margins.get(name, np.nan)) for tried in cars for name in self._criteria]
        limits = [tried.limits.get(name, np.nan) for tried in cars for name in self._limits]
        return np.array([*margins, *limits])

    def _step(self, point: Array, cars: Sequence[Tried], slopes: Array, radius: float) -> Array:
        """The best step of at most `radius` in each parameter if everything went straight on.

        While a hard limit is not kept, all that counts is how far it is.
        """
        figures, free, kinds = self._figures(cars), len(point), len(self._criteria)
        count = kinds * len(cars)
        margins, known = figures[:count], np.flatnonzero(np.isfinite(figures[count:])) + count
        box: list[Any] = [*zip(np.maximum(-radius, -point), np.minimum(radius, 1.0 - point), strict=True)]
        room, falls = figures[known], -slopes[known]
        if np.any(room < 0.0) or not np.all(np.isfinite(margins)):  # unknown: step, least room
            rows = np.hstack([falls, np.ones((len(room), 1))])
            return _solved(np.r_[np.zeros(free), -1.0], rows, room, [*box, (None, 0.0)])[:free]
        # unknown: step, least margin of each criterion, least of all, how much of the cushion is used up
        each, one = np.eye(kinds), np.ones((kinds, 1))
        own = np.hstack([-slopes[:count], np.tile(np.hstack([each, 0.0 * one, 0.0 * one]), (len(cars), 1))])
        least = np.hstack([np.zeros((kinds, free)), -each, one, 0.0 * one])
        kept = np.hstack([falls, np.zeros((len(room), kinds + 1)), -np.ones((len(room), 1))])
        cushion = min(_CUSHION, 0.25 * radius)
        return _solved(
            np.r_[np.zeros(free), np.full(kinds, -MEAN_SHARE / kinds), -1.0, 1.0],
            np.vstack([own, least, kept]),
            np.r_[margins, np.zeros(kinds), room - cushion],
            [*box, *[(None, None)] * (kinds + 1), (0.0, None)],
        )[:free]


def _solved(cost: Array, rows: Array, above: Array, bounds: Any) -> Array:
    """What makes `cost` least where rows @ x <= above; no step where there is none."""
    from scipy.optimize import linprog

    found = linprog(cost, A_ub=rows, b_ub=above, bounds=bounds, method="highs")
    return np.zeros(len(cost)) if found.x is None else np.asarray(found.x)
