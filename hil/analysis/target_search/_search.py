"""Coarse to fine: every candidate alone, the best in pairs, the best of all refined.

Every look is a whole run of the plan: what a loop does late, it does not show early. What a ripple does
depends on where it meets a resonance, so that there are many hollows: refinement is by differential evolution
(Storn and Price, Journal of Global Optimization 11 (1997)), and in the end by the method of Nelder and Mead
(The Computer Journal 7 (1965)). The same seed gives the same guesses.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.analysis.target_search._plausible import Candidate
from hil.analysis.target_search._trial import Trial, guess_at

Array = npt.NDArray[np.float64]
Set = tuple[Candidate, ...]

_MOVERS = 5  # candidates that pairs are made of
_SHARES = (0.2, 0.15)  # of the evaluations: alone, in pairs; the others refine
_ROUNDS = ((4, 0.4), (2, 0.5), (1, 0.8))
"""Sets that evolve, and the share of what evaluations are left that they have together."""
_POPULATION = 6  # for each number
_APART = 0.02  # of a range: points that are nearer are one and the same


@dataclass(frozen=True)
class Found:
    """A guess of a set of candidates: its point in the unit cube, and its cost."""

    chosen: Set
    point: Array
    cost: float

    @property
    def name(self) -> str:
        """Ids of the set, for people."""
        return " + ".join(candidate.id for candidate in self.chosen)


class _StoppedError(Exception):
    """Somebody asked to stop, or the evaluations are used up."""


class Search:
    """Guesses executed so far; `best` has the best of each set."""

    def __init__(
        self,
        trial: Trial,
        evaluations: int,
        seed: int,
        show: Callable[[str, float | None], None],
        stopped: Callable[[], bool],
    ) -> None:
        self._trial, self._evaluations, self._seed = trial, evaluations, seed
        self._show, self._stopped = show, stopped
        self.done = 0
        self.interrupted = False
        self._seen: dict[Set, dict[bytes, Found]] = {}
        self._best: dict[Set, Found] = {}
        self._populations: dict[Set, Array] = {}

    @property
    def best(self) -> list[Found]:
        """The best of each set, least cost first."""
        return sorted(self._best.values(), key=lambda one: one.cost)

    def places(self, chosen: Set, most: int) -> list[Found]:
        """The best guesses of a set that differ, at most so many, least cost first."""
        kept: list[Found] = []
        for one in sorted(self._seen[chosen].values(), key=lambda one: one.cost):
            if all(np.max(np.abs(one.point - other.point)) > _APART for other in kept):
                kept.append(one)
            if len(kept) == most:
                break
        return kept

    def execute(self, every: Set) -> None:
        """Search; ends early when somebody asks to stop, and keeps what is known."""
        try:
            self._alone(every)
            self._pairs()
            self._refine()
        except _StoppedError:
            self.interrupted = True

    def _alone(self, every: Set) -> None:
        each = max(2, int(_SHARES[0] * self._evaluations / len(every)))
        for candidate in every:
            self._scatter((candidate,), each, [])

    def _pairs(self) -> None:
        pairs = list(itertools.combinations(self.best[:_MOVERS], 2))
        each = max(2, int(_SHARES[1] * self._evaluations / max(1, len(pairs))))
        for one, two in pairs:
            self._scatter((*one.chosen, *two.chosen), each, [np.concatenate([one.point, two.point])])

    def _refine(self) -> None:
        for sets, share in _ROUNDS:
            starts = self.best[:sets]
            for start in starts:
                self._evolve(start.chosen, int(share * self._left / len(starts)))
        self._descend(self.best[0], max(2 + len(self.best[0].point), self._left), 0.04)

    @property
    def _left(self) -> int:
        return max(0, self._evaluations - self.done)

    def _evolve(self, chosen: Set, most: int) -> None:
        """Generations of about `most` looks, from the last ones of the set, or from its best and others."""
        from scipy.optimize import Bounds, differential_evolution
        from scipy.stats import qmc

        size = sum(len(candidate.numbers) for candidate in chosen)
        population = self._populations.get(chosen)
        if population is None:
            known = [one.point for one in self.places(chosen, _POPULATION * size // 2)]
            further = qmc.LatinHypercube(size, seed=self._seed + 1).random(_POPULATION * size - len(known))
            population = np.vstack([*known, further])
            most -= len(further)
        generations = most // len(population)
        if generations < 1:
            return
        found = differential_evolution(
            functools.partial(self._look, chosen),
            Bounds(np.zeros(size), np.ones(size)),
            init=population,
            maxiter=generations,
            mutation=(0.4, 0.9),
            recombination=0.8,
            tol=0.0,
            polish=False,
            seed=self._seed,
        )
        self._populations[chosen] = np.asarray(found.population)

    def _descend(self, start: Found, most: int, step: float) -> None:
        """From the best of a set, `most` looks with a first simplex of `step`."""
        from scipy.optimize import minimize

        inward = np.where(start.point > 0.5, -step, step)
        simplex = np.vstack([start.point, start.point + np.diag(inward)])
        options: Any = {"maxfev": most, "initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-6}
        look = functools.partial(self._look, start.chosen)
        bounds = [(0.0, 1.0)] * len(start.point)
        minimize(look, start.point, method="Nelder-Mead", bounds=bounds, options=options)

    def _scatter(self, chosen: Set, count: int, first: list[Array]) -> None:
        """A Latin hypercube over the ranges, behind the points in `first`."""
        from scipy.stats import qmc

        size = sum(len(candidate.numbers) for candidate in chosen)
        points = qmc.LatinHypercube(size, seed=self._seed).random(max(1, count - len(first)))
        for point in [*first, *points]:
            self._look(chosen, np.asarray(point))

    def _look(self, chosen: Set, point: Array) -> float:
        point = np.clip(np.asarray(point, dtype=float), 0.0, 1.0)
        seen = self._seen.setdefault(chosen, {})
        if point.tobytes() in seen:
            return seen[point.tobytes()].cost
        if self._stopped():
            raise _StoppedError
        cost = self._trial.of(guess_at(point, chosen)).cost(self._trial.targets)
        self.done += 1
        seen[point.tobytes()] = Found(chosen, point.copy(), cost)
        if chosen not in self._best or cost < self._best[chosen].cost:
            self._best[chosen] = seen[point.tobytes()]
        least = min(self._best.values(), key=lambda one: one.cost)
        share = min(1.0, self.done / self._evaluations)
        self._show(f"{self.done}, best so far {least.name}: {least.cost:.3g}", share)
        return cost
