"""Coarse to fine: every candidate alone, the best in pairs, the best of all refined.

Coarse looks see the first seconds of each step only; refinement (Nelder and Mead, The Computer Journal 7
(1965)) sees the whole plan. The same seed gives the same guesses.
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
from hil.analysis.target_search._trial import Outcome, Trial, guess_at

Array = npt.NDArray[np.float64]
Set = tuple[Candidate, ...]

#: Seconds after a step that a coarse look sees.
COARSE_S = 4.0
_MOVERS = 5  # candidates that pairs are made of
_REFINED = 4
_SHARES = (0.3, 0.3, 0.4)  # of the evaluations: alone, in pairs, refined
_SIMPLEX = 0.12  # of a range, first step of a refinement


@dataclass(frozen=True)
class Found:
    """The best guess of a set of candidates so far: its point in the unit cube, and its cost."""

    chosen: Set
    point: Array
    cost: float
    refined: bool

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
        self._coarse: dict[Set, Found] = {}
        self._fine: dict[Set, Found] = {}

    @property
    def best(self) -> list[Found]:
        """The best of each set, refined ones first, least cost first."""
        fine = sorted(self._fine.values(), key=lambda one: one.cost)
        coarse = [one for key, one in self._coarse.items() if key not in self._fine]
        return [*fine, *sorted(coarse, key=lambda one: one.cost)]

    def carry_out(self, every: Set) -> None:
        """Search; ends early when somebody asks to stop, and keeps what is known."""
        try:
            self._alone(every)
            self._pairs()
            self._refine()
        except _StoppedError:
            self.interrupted = True

    def outcome(self, found: Found) -> Outcome:
        """What a found guess gives in the whole plan."""
        return self._trial.of(guess_at(found.point, found.chosen))

    def _alone(self, every: Set) -> None:
        each = max(2, int(_SHARES[0] * self._evaluations / len(every)))
        for candidate in every:
            self._scatter((candidate,), each, [])

    def _pairs(self) -> None:
        alone = sorted(self._coarse.values(), key=lambda one: one.cost)[:_MOVERS]
        pairs = list(itertools.combinations(alone, 2))
        each = max(2, int(_SHARES[1] * self._evaluations / max(1, len(pairs))))
        for one, two in pairs:
            self._scatter((*one.chosen, *two.chosen), each, [np.concatenate([one.point, two.point])])

    def _refine(self) -> None:
        starts = sorted(self._coarse.values(), key=lambda one: one.cost)[:_REFINED]
        each = max(10, int(_SHARES[2] * self._evaluations / max(1, len(starts))))
        for start in starts:
            inward = np.where(start.point > 0.5, -_SIMPLEX, _SIMPLEX)
            simplex = np.vstack([start.point, start.point + np.diag(inward)])
            options: Any = {"maxfev": each, "initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-6}
            fine = functools.partial(self._look, start.chosen, fine=True)
            bounds = [(0.0, 1.0)] * len(start.point)
            minimize(fine, start.point, method="Nelder-Mead", bounds=bounds, options=options)

    def _scatter(self, chosen: Set, count: int, first: list[Array]) -> None:
        """A Latin hypercube over the ranges, behind the points in `first`."""
        size = sum(len(candidate.numbers) for candidate in chosen)
        points = qmc.LatinHypercube(size, seed=self._seed).random(max(1, count - len(first)))
        for point in [*first, *points]:
            self._look(chosen, np.asarray(point), fine=False)

    def _look(self, chosen: Set, point: Array, *, fine: bool) -> float:
        if self._stopped():
            raise _StoppedError
        point = np.clip(point, 0.0, 1.0)
        outcome = self._trial.of(guess_at(point, chosen), np.inf if fine else COARSE_S)
        cost = outcome.cost(self._trial.targets)
        self.done += 1
        best = self._fine if fine else self._coarse
        if chosen not in best or cost < best[chosen].cost:
            best[chosen] = Found(chosen, point.copy(), cost, fine)
        least = min(best.values(), key=lambda one: one.cost)
        share = min(1.0, self.done / self._evaluations)
        self._show(f"{self.done}, best so far {least.name}: {least.cost:.3g}", share)
        return cost
