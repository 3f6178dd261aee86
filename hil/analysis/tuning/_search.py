"""Global, then local; few cars while far, all of them at the end.

Differential evolution (Storn and Price, J. Global Optimization 11 (1997) 341) over the whole space on the
model itself, again around the best on the cars that were worst for it, then the method of Nelder and Mead
(Computer Journal 7 (1965) 308) on a set of cars that grows: every car is tried with the best, the worst join
the set, until the worst of all is in it. The same seed gives the same candidates on any number of cores.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import differential_evolution, minimize

from hil.analysis.tuning._parameters import Space
from hil.analysis.tuning._pool import Pool
from hil.analysis.tuning._trial import Tried

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Effort:
    """How much is tried.

    Attributes:
        far: generations on the model itself; between: on the worst cars.
        members: of a generation, for each free parameter.
        near: candidates of one local search, for each free parameter.
        rounds: of local searches at most.
        joining: cars that join the set in a round.
    """

    far: int = 20
    between: int = 8
    members: int = 5
    near: int = 16
    rounds: int = 4
    joining: int = 4


class StoppedError(Exception):
    """Somebody asked to stop, or the time is up."""


class Search:
    """What was tried so far: `archive` on the model itself, `best` the candidate that is best so far.

    Args:
        pool: tries candidates.
        space: what is free.
        start: point to begin with.
        seed: of everything random.
        stopped: asked before each batch.
        show: told what is being done, and how much of it is done.
    """

    def __init__(
        self,
        pool: Pool,
        space: Space,
        start: Array,
        seed: int,
        effort: Effort,
        show: Callable[[str, float | None], None],
        stopped: Callable[[], bool],
    ) -> None:
        self._pool, self._space, self._seed, self._effort = pool, space, seed, effort
        self._show, self._stopped = show, stopped
        self.archive: list[Tried] = []
        self.best = start
        self._best_score, self._doing = -np.inf, ""
        self._active: tuple[int, ...] = (0,)
        self.ended = "converged"

    def carry_out(self) -> None:
        """Search; ends early when somebody asks to stop, and keeps what is known."""
        cars = len(self._pool.trial.draws)
        try:
            self._evolve("far", self._effort.far, np.clip(self.best, 0.0, 1.0), 0.5)
            if cars > 1:
                self._join()
                self._evolve("between", self._effort.between, self.best, 0.15)
            for number in range(self._effort.rounds):
                self._descend(number)
                if cars == 1 or not self._join():
                    return
            self.ended = "rounds used up"
        except StoppedError:
            self.ended = "stopped"

    def everywhere(self, point: Array) -> list[Tried]:
        """A candidate on every car, by number; goes on when somebody asks to stop."""
        values = self._space.values(point)
        return self._pool.tried([(values, number) for number in range(len(self._pool.trial.draws))])

    def _evolve(self, name: str, generations: int, start: Array, width: float) -> None:
        """Differential evolution on the active cars, its first generation `width` around `start`."""
        self._begin(name)
        random = np.random.default_rng([self._seed, len(self._active)])
        members = max(8, self._effort.members * self._space.size)
        first = start + width * random.uniform(-1, 1, (members, self._space.size))
        if width >= 0.5:  # all over the cube
            first = random.uniform(0, 1, first.shape)
        first[0] = start
        settings: Any = {
            "bounds": [(0.0, 1.0)] * self._space.size,
            "init": np.clip(first, 0.0, 1.0),
            "maxiter": generations,
            "vectorized": True,
            "updating": "deferred",
            "polish": False,
            "tol": 0.0,
            "seed": random,
        }
        differential_evolution(self._costs, **settings)

    def _descend(self, number: int) -> None:
        """Nelder and Mead on the active cars from the best so far."""
        self._begin(f"near, {len(self._active)} cars")
        step = 0.08 / (1 + number)
        inward = np.where(self.best > 0.5, -step, step)
        simplex = np.vstack([self.best, self.best + np.diag(inward)])
        options: Any = {
            "initial_simplex": simplex,
            "maxfev": self._effort.near * self._space.size,
            "xatol": 1e-3,
            "fatol": 1e-5,
            "adaptive": True,
        }
        bounds: Any = [(0.0, 1.0)] * self._space.size
        minimize(self._cost, self.best, method="Nelder-Mead", bounds=bounds, options=options)

    def _costs(self, points: Any) -> Any:
        """Of a generation, a column for each candidate."""
        return -np.array(self._scores(list(points.T)))

    def _cost(self, point: Any) -> float:
        return -self._scores([point])[0]

    def _begin(self, doing: str) -> None:
        """Scores on other cars are not to be compared with those before."""
        self._doing, self._best_score = doing, -np.inf

    def _join(self) -> bool:
        """Let the cars on which the best is worst join the active ones; whether any has."""
        self._refuse_if_stopped()
        self._show(f"all {len(self._pool.trial.draws)} cars", None)
        found = sorted(self.everywhere(self.best), key=lambda tried: tried.score)
        least = min(tried.score for tried in found if tried.draw in self._active)
        worse = [t.draw for t in found if t.score < least and t.draw not in self._active]
        self._active = (*self._active, *worse[: self._effort.joining])
        return bool(worse)

    def _scores(self, points: Sequence[Array]) -> list[float]:
        """Of each candidate on the active cars: the worst."""
        self._refuse_if_stopped()
        points = [np.clip(point, 0.0, 1.0) for point in points]
        values = [self._space.values(point) for point in points]
        work = [(one, number) for one in values for number in self._active]
        found = self._pool.tried(work)
        self.archive += [tried for tried in found if tried.draw == 0]
        cars = len(self._active)
        scores = [min(t.score for t in found[i * cars : (i + 1) * cars]) for i in range(len(points))]
        for point, score in zip(points, scores, strict=True):
            if score > self._best_score:
                self.best, self._best_score = point.copy(), score
        self._show(
            f"{self._doing}: {self._pool.runs} runs, worst margin {100 * self._best_score:.1f} %", None
        )
        return scores

    def _refuse_if_stopped(self) -> None:
        if self._stopped():
            raise StoppedError
