"""The best step within a trust region: uphill on margins as the runs so far have corrected them.

What runs have shown of margins beside what was predicted: output space mapping.

J. W. Bandler et al., "Space mapping: the state of the art", IEEE Trans. Microwave Theory Tech. 52 (2004)
337: a coarse model, here the predicted run, is corrected so that it agrees with the fine one, here the bench,
where that was tried.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.tuning._ascent import Ascent
from hil.analysis.tuning._parameters import Space
from hil.analysis.tuning._pool import Pool
from hil.analysis.tuning._trial import Tried

Array = npt.NDArray[np.float64]

#: Runs closer together than this, in ranges of the parameters, say less of a slope than of their noise.
_TOO_NEAR = 0.05


@dataclass(frozen=True)
class Correction:
    """Measured less predicted margins, exact at `centre`, with the slope that earlier runs show.

    `offset` has one number for each margin, `slope` a row for each margin and a column for each parameter.
    """

    centre: Array
    offset: Array
    slope: Array

    def at(self, point: Array) -> Array:
        """What is to be added to the margins that are predicted at a point of the unit cube."""
        return np.asarray(self.offset + self.slope @ (point - self.centre))


def correction_of(points: list[Array], apart: list[Array], centre: int) -> Correction:
    """From runs at `points`, of which measured and predicted margins were `apart`; exact at `centre`.

    The slope is the least one that explains the other runs, by ridge regression: a direction in which nothing
    was tried has none.
    """
    middle, offset = points[centre], apart[centre]
    others = [number for number in range(len(points)) if number != centre]
    steps = np.array([points[number] - middle for number in others]).reshape(-1, middle.size)
    changes = np.array([apart[number] - offset for number in others]).reshape(-1, offset.size)
    near = steps.T @ steps + _TOO_NEAR**2 * np.eye(middle.size)
    return Correction(middle, offset, np.linalg.solve(near, steps.T @ changes).T)


_ROUNDS = 6
_CHECKED = 5  # of the candidates that promise most, on every car
SAME = 1e-4  # of margins: less than this is no difference
_RADIUS, _SHORTEST = 0.5, 0.02  # of the first and of the last step of an ascent, shares of the region's width


class _StoppedError(Exception):
    """Somebody asked."""


@dataclass(frozen=True)
class Promise:
    """A candidate: as predicted on the model itself, and with its margins as runs have corrected them."""

    point: Array
    tried: Tried
    corrected: Tried

    @property
    def worst(self) -> float:
        """The least corrected margin."""
        return min(self.corrected.margins.values())


class TrustStep:
    """Looks for candidates around a centre, no worse on other cars of the trial than what is at `start`."""

    def __init__(self, pool: Pool, space: Space, start: Array, stopped: Callable[[], bool]) -> None:
        self._pool, self._space, self._stopped = pool, space, stopped
        self._least = min((car.worst for car in self._on_others(start)), default=0.0)

    def best(self, centre: Promise, correction: Correction, radius: float) -> Promise:
        """What promises most within `radius`; the centre itself if nothing promises more."""
        low, high = np.maximum(centre.point - radius, 0.0), np.minimum(centre.point + radius, 1.0)
        seen: list[Promise] = []

        def tried_on(shares: Sequence[Array]) -> Sequence[Sequence[Tried]]:
            """Candidates by their place in the region, which is a unit cube to the ascent."""
            if self._stopped():
                raise _StoppedError
            found = self._promises([low + share * (high - low) for share in shares], correction)
            seen.extend(one for one in found if one.corrected.feasible)
            return [(one.corrected,) for one in found]

        trial = self._pool.trial
        criteria = [criterion.id for criterion in trial.driven.criteria]
        ascent = Ascent(tried_on, criteria, trial.limits)
        try:
            ascent.execute((centre.point - low) / (high - low), _RADIUS, _SHORTEST, _ROUNDS)
        except _StoppedError:
            return centre
        better = [one for one in seen if one.corrected.score > centre.corrected.score]
        better.sort(key=lambda one: -one.corrected.score)
        return next((one for one in better[:_CHECKED] if self._on_every_car(one)), centre)

    def promise(self, point: Array, correction: Correction) -> Promise | None:
        """A candidate on the model itself; None beyond a hard limit."""
        (found,) = self._promises([point], correction)
        return found if found.tried.feasible else None

    def _promises(self, points: Sequence[Array], correction: Correction) -> list[Promise]:
        tried = self._pool.tried([(self._space.values(point), 0) for point in points])
        return [
            Promise(point, one, _corrected(one, correction.at(point)))
            for point, one in zip(points, tried, strict=True)
        ]

    def _on_every_car(self, one: Promise) -> bool:
        """Whether it keeps the hard limits on the others, too, and no worse there than the start."""
        tried = self._on_others(one.point)
        return all(car.feasible and car.worst >= self._least - SAME for car in tried)

    def _on_others(self, point: Array) -> list[Tried]:
        """A candidate on every car but the model itself."""
        values, cars = self._space.values(point), range(1, len(self._pool.trial.draws))
        return self._pool.tried([(values, number) for number in cars])


def _corrected(tried: Tried, correction: Array) -> Tried:
    if not tried.margins:
        return tried
    more = zip(tried.margins.items(), correction.tolist(), strict=True)
    return replace(tried, margins={name: margin + change for (name, margin), change in more})
