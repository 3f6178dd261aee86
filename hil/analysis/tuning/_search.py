"""Global, then local; few cars while far, many at the end.

Far: points all over the space are tried on the model itself, and from the best of them and from the start it
goes uphill there (`Ascent`). Near: every car is tried with the best, those that matter join the model itself,
and from the best of all hills it goes uphill on these together; again, until no car changes what counts. The
same seed gives the same candidates on any number of cores.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.tuning._ascent import Ascent, scatter, score
from hil.analysis.tuning._parameters import Space
from hil.analysis.tuning._pool import Pool
from hil.analysis.tuning._trial import Tried
from hil.analysis.tuning._trust_step import SAME
from hil.core.errors.wording import share

Array = npt.NDArray[np.float64]

_FAR, _NEAR = 0.2, 0.08  # radius that an ascent begins with, as a share of the parameters' ranges
_SHORTEST = 1e-3  # step that ends it
_SCATTERED = 10  # points for each that is gone uphill from
_AT_ONCE = 32  # points all over the space between two words about how far it is
_FAR_SHARE = 0.3  # of the time, when there are draws
_BACK = (0.98, 0.95, 0.9, 0.8, 0.65, 0.5, 0.3, 0.15, 0.0)  # of the way from the start


@dataclass(frozen=True)
class Effort:
    """How much is tried.

    Attributes:
        starts: of ascents on the model itself, beside the plan's own controller: the best of ten times as
            many points all over the space.
        far, near: rounds of an ascent at most, on the model itself and on several cars.
        joins: times that cars join.
        joining: cars that join at once.
    """

    starts: int = 6
    far: int = 25
    near: int = 12
    joins: int = 8
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
        show: called with what is being done, and how much of it is done.
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
        self.best = self._start = np.clip(start, 0.0, 1.0)
        self._best_score = self._best_worst = -np.inf
        self._best_cars: list[Tried] = []  # the best on the cars that it was searched on
        self._doing, self._share = "", 0.0
        self._active: tuple[int, ...] = (0,)
        self._joined: tuple[Array, list[Tried]] | None = None  # best of those that were tried on every car
        self.ended = "converged"

    def execute(self) -> None:
        """Search; ends early when somebody asks to stop, and keeps what is known."""
        try:
            hills = self._far()
            if len(self._pool.trial.draws) > 1:
                self.ended = "rounds used up"
                self._near(hills)
        except StoppedError:
            self.ended = "stopped"

    def everywhere(self) -> list[Tried]:
        """The best on every car, by number; goes on when somebody asks to stop.

        What was best on some cars gives way to what is known to be better on all of them.
        """
        found = self._on_all(self.best)
        if self._joined is not None and score(self._joined[1]) > score(found):
            self.best, found = self._joined
        return found if all(tried.feasible for tried in found) else self._backed_off(found)

    def _backed_off(self, found: list[Tried]) -> list[Tried]:
        """The best moved towards the start until it keeps every limit on every car; `found` if nothing does.

        The start is as far as can be from all that must not get worse than with it, on every car.
        """
        beyond = [number for number, tried in enumerate(found) if not tried.feasible]
        for share_of_way in _BACK:
            point = self._start + share_of_way * (self.best - self._start)
            values = self._space.values(point)
            if not all(tried.feasible for tried in self._pool.tried([(values, n) for n in beyond])):
                continue
            every = self._on_all(point)
            beyond += [n for n, tried in enumerate(every) if not tried.feasible and n not in beyond]
            if all(tried.feasible for tried in every):
                self.best = point
                return every
        return found

    def so_far(self) -> list[Tried]:
        """The best when somebody has asked to stop, on the cars that it was searched on, by their order.

        Every other car would take as long as a part of the search. What was best on some cars gives way to
        what is known to be better on all of them.
        """
        if not self._best_cars:
            self._best_cars = self._pool.tried([(self._space.values(self.best), 0)])
        if self._joined is not None and score(self._joined[1]) > score(self._best_cars):
            self.best, every = self._joined
            return [every[tried.draw] for tried in self._best_cars]
        return self._best_cars

    def _far(self) -> list[Array]:
        """Uphill on the model itself from several points; where that ended, best first."""
        self._begin("far")
        random = np.random.default_rng(self._seed)
        points = scatter(self._space.size, _SCATTERED * self._effort.starts, random)
        own = self.best
        scores: list[float] = []
        for first in range(0, len(points), _AT_ONCE):
            scores += [score(cars) for cars in self._tried(points[first : first + _AT_ONCE])]
        order = np.argsort(scores, kind="stable")[::-1]
        lines = [own, *(points[i] for i in order[: self._effort.starts])]
        whole = _FAR_SHARE if len(self._pool.trial.draws) > 1 else 1.0
        ends = []
        for number, point in enumerate(lines):
            self._share = whole * (number + 1) / (len(lines) + 2)
            ends.append(self._uphill(point, _FAR, self._effort.far))
        self._share = whole * (len(lines) + 1) / (len(lines) + 2)
        ends.append(self._uphill(self.best, _NEAR, self._effort.far))
        ends.sort(key=lambda end: -end[0])
        return [point for _, point in ends]

    def _near(self, hills: Sequence[Array]) -> None:
        """Uphill on the cars that matter, which become more."""
        candidates = list(hills)
        for number in range(self._effort.joins):
            self._share = _FAR_SHARE + (1.0 - _FAR_SHARE) * number / (self._effort.joins + 1)
            if not self._join():
                self.ended = "converged"
                return
            self._begin(f"near, {len(self._active)} cars")
            candidates = [self.best, *candidates] if number == 0 else [self.best]
            scores = [score(cars) for cars in self._tried(candidates)]
            self._uphill(candidates[int(np.argmax(scores))], _NEAR, self._effort.near)
        self._join()

    def _uphill(self, start: Array, radius: float, rounds: int) -> tuple[float, Array]:
        """Ascend on the active cars; score and place of the best on the way."""
        best = [(-np.inf, start)]

        def tried_on(points: Sequence[Array]) -> Sequence[Sequence[Tried]]:
            found = self._tried(points)
            best.extend((score(cars), point) for cars, point in zip(found, points, strict=True))
            best[:] = [max(best, key=lambda one: one[0])]
            return found

        limits = self._pool.trial.limits
        criteria = [criterion.id for criterion in self._pool.trial.driven.criteria]
        Ascent(tried_on, criteria, limits).execute(start, radius, _SHORTEST, rounds)
        return best[0]

    def _join(self) -> bool:
        """Let the cars that lower the best's score most join the active ones; whether any does."""
        self._show(f"all {len(self._pool.trial.draws)} cars", self._share)
        found = self._on_all(self.best, self._refuse_if_stopped)
        whole = score(found)
        if self._joined is None or whole > score(self._joined[1]):
            self._joined = self.best, found
        active = list(self._active)
        while len(active) < len(self._active) + self._effort.joining:
            known = [found[number] for number in active]
            if score(known) < whole + SAME:
                break
            lowered = [score([*known, one]) for one in found]
            active.append(int(np.argmin(lowered)))
        joined = len(active) > len(self._active)
        self._active = tuple(active)
        self._best_cars = [found[number] for number in active]
        return joined

    def _begin(self, doing: str) -> None:
        """Scores on other cars are not to be compared with those before."""
        self._doing = doing
        self._best_score = self._best_worst = -np.inf

    def _on_all(self, point: Array, ask: Callable[[], None] = lambda: None) -> list[Tried]:
        """A candidate on every car; `ask` is called now and then, and may raise."""
        values = self._space.values(point)
        return self._pool.tried([(values, number) for number in range(len(self._pool.trial.draws))], ask)

    def _tried(self, points: Sequence[Array]) -> list[list[Tried]]:
        """Each candidate on the active cars."""
        cars = len(self._active)
        values = [self._space.values(point) for point in points]
        work = [(one, number) for one in values for number in self._active]
        found = self._pool.tried(work, self._refuse_if_stopped)
        self.archive += [tried for tried in found if tried.draw == 0]
        each = [found[i * cars : (i + 1) * cars] for i in range(len(points))]
        for point, tried in zip(points, each, strict=True):
            if score(tried) > self._best_score:
                self.best, self._best_score, self._best_cars = np.array(point), score(tried), tried
                self._best_worst = min(one.worst for one in tried)
        worst = f"worst margin {share(self._best_worst)}"
        self._show(f"{self._doing}: {self._pool.runs} runs, {worst}", self._share)
        return each

    def _refuse_if_stopped(self) -> None:
        if self._stopped():
            raise StoppedError
