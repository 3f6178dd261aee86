"""Coarse to fine: every candidate alone, the best in pairs, the best of all refined.

Every look is a whole run of the plan: what a loop does late, it does not show early. Refinement is the method
of Nelder and Mead (The Computer Journal 7 (1965)), begun again around the best. The same seed gives the same
guesses.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize
from scipy.stats import qmc

from hil.analysis.target_search._plausible import Candidate
from hil.analysis.target_search._trial import Trial, guess_at

Array = npt.NDArray[np.float64]
Set = tuple[Candidate, ...]

_MOVERS = 5  # candidates that pairs are made of
_REFINED = 4
_SHARES = (0.25, 0.3)  # of the evaluations: alone, in pairs; the others refine
_ROUNDS = ((_REFINED, 0.4, 0.12), (1, 0.5, 0.08), (1, 1.0, 0.04))
"""Sets that are refined, share of what evaluations are left, first step as a share of a range."""


@dataclass(frozen=True)
class Found:
    """The best guess of a set of candidates so far: its point in the unit cube, and its cost."""

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
    """Guesses carried out so far; `best` has the best of each set."""

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
        self._best: dict[Set, Found] = {}

    @property
    def best(self) -> list[Found]:
        """The best of each set, least cost first."""
        return sorted(self._best.values(), key=lambda one: one.cost)

    def carry_out(self, every: Set) -> None:
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
        for sets, share, step in _ROUNDS:
            starts = self.best[:sets]
            left = max(0, self._evaluations - self.done)
            for start in starts:
                self._descend(start, max(2 + len(start.point), int(share * left / len(starts))), step)

    def _descend(self, start: Found, most: int, step: float) -> None:
        """From the best of a set, `most` looks with a first simplex of `step`."""
        inward = np.where(start.point > 0.5, -step, step)
        simplex = np.vstack([start.point, start.point + np.diag(inward)])
        options: Any = {"maxfev": most, "initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-6}
        look = functools.partial(self._look, start.chosen)
        bounds = [(0.0, 1.0)] * len(start.point)
        minimize(look, start.point, method="Nelder-Mead", bounds=bounds, options=options)

    def _scatter(self, chosen: Set, count: int, first: list[Array]) -> None:
        """A Latin hypercube over the ranges, behind the points in `first`."""
        size = sum(len(candidate.numbers) for candidate in chosen)
        points = qmc.LatinHypercube(size, seed=self._seed).random(max(1, count - len(first)))
        for point in [*first, *points]:
            self._look(chosen, np.asarray(point))

    def _look(self, chosen: Set, point: Array) -> float:
        if self._stopped():
            raise _StoppedError
        point = np.clip(point, 0.0, 1.0)
        cost = self._trial.of(guess_at(point, chosen)).cost(self._trial.targets)
        self.done += 1
        if chosen not in self._best or cost < self._best[chosen].cost:
            self._best[chosen] = Found(chosen, point.copy(), cost)
        least = min(self._best.values(), key=lambda one: one.cost)
        share = min(1.0, self.done / self._evaluations)
        self._show(f"{self.done}, best so far {least.name}: {least.cost:.3g}", share)
        return cost
