"""From a plan's criteria to a controller: search, then everything that shows why it is this one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.tuning._kept import CRITERIA, KEPT, Worse, worse_of
from hil.analysis.tuning._parameters import (
    PAPER_LEAD,
    PAPER_NOTCH,
    Space,
    refuse_missing_tables,
    refuse_wide_margin,
    values_of,
)
from hil.analysis.tuning._pool import Pool
from hil.analysis.tuning._search import Effort, Search
from hil.analysis.tuning._trial import Trial, Tried
from hil.core.controller import Controller
from hil.core.errors import BadInputError
from hil.core.model import Model, refuse_without_vehicle
from hil.plant import refuse_too_stiff

Array = npt.NDArray[np.float64]

#: Step of the sensitivities, as a share of a parameter's range.
SENSITIVITY_STEP = 0.02
_NO_ROOM = 0.004  # of the share that is kept: the search comes no nearer
_SAME_MARGIN = 0.01  # % of a limit


@dataclass(frozen=True)
class Standing:
    """One controller with what it came to on every car that it was tried on, the model itself first."""

    name: str
    controller: Controller
    values: Mapping[str, float]
    tried: tuple[Tried, ...]

    @property
    def nominal(self) -> Tried:
        """On the model itself."""
        return self.tried[0]

    @property
    def worst(self) -> Tried:
        """On the car that it is worst on."""
        return min(self.tried, key=lambda one: one.worst)

    def least_margin(self, criterion: str) -> float:
        """Over all cars; a car on which it was not run counts as -1."""
        return min(tried.margins.get(criterion, -1.0) for tried in self.tried)


@dataclass(frozen=True)
class Tuning:
    """What a search came to.

    Attributes:
        trial: what was tried, on which cars: of a search that was stopped, those that it had got to.
        space: what was free.
        chosen, start: the controller that was found, and the plan's own.
        others: the paper's lead and notch in its place, where they are not the start.
        archive: every candidate on the model itself.
        sensitivities: change of each criterion's margin by criterion and parameter, for a step of the whole
            range of the parameter, from central differences.
        ended: converged, rounds used up or stopped.
        runs: predicted runs.
    """

    trial: Trial
    space: Space
    chosen: Standing
    start: Standing
    others: tuple[Standing, ...]
    archive: tuple[Tried, ...]
    sensitivities: Mapping[str, Mapping[str, float]]
    ended: str
    runs: int

    @property
    def shown(self) -> tuple[Standing, ...]:
        """Every controller that is compared."""
        return (self.chosen, self.start, *self.others)

    @property
    def worse(self) -> tuple[Worse, ...]:
        """What is worse than with the start, on the car where it is so most; the plan's criteria first."""
        before = [tried.figures for tried in self.start.tried]
        figures = worse_of(before, [tried.figures for tried in self.chosen.tried])
        return (*self._worse_criteria, *figures)

    @property
    def _worse_criteria(self) -> tuple[Worse, ...]:
        """Criteria that lost margin on the car that is worst for them, in % of the limit."""
        found = []
        for id_ in self.traded:
            start, own = 100 * self.start.least_margin(id_), 100 * self.chosen.least_margin(id_)
            car = min(self.chosen.tried, key=lambda one: one.margins.get(id_, -1.0)).draw
            if start - own > _SAME_MARGIN:
                found.append(Worse(f"margin, {id_}", "%", start, own, (start - own) / 100, car))
        return tuple(sorted(found, key=lambda one: -one.share))

    @property
    def failed_checks(self) -> tuple[str, ...]:
        """What any device must do and the chosen controller does not, on some car; the start fails it too."""
        ids = [check.id for check in self.trial.device_checks]
        return tuple(i for i in ids if any(tried.device.get(i, 0.0) < 0.0 for tried in self.chosen.tried))

    @property
    def start_fails(self) -> bool:
        """Whether the start fails the plan on the model itself: of it, hard limits alone are kept there."""
        return min(self.start.nominal.margins.values(), default=-1.0) < 0.0

    @property
    def held_by(self) -> tuple[str, ...]:
        """Of what is kept, that which has no more room on some car: a search with it let go may gain more."""
        groups = {one.limit: one.group for one in self.trial.kept}
        least: dict[str, float] = {}
        for tried in self.chosen.tried:
            for name, room in tried.limits.items():
                if name.startswith("keep."):
                    group = groups.get(name, CRITERIA)
                    least[group] = min(room, least.get(group, np.inf))
        return tuple(name for name in KEPT if least.get(name, np.inf) < _NO_ROOM)

    @property
    def worst_figure(self) -> Worse:
        """Of what is worse, that which is so most."""
        return self.worse[0]

    @property
    def better_in_every_criterion(self) -> bool:
        """Than the start: each on the car that is worst for it, and nothing that is kept is worse on any."""
        ids = [criterion.id for criterion in self.trial.driven.criteria]
        better = all(self.chosen.least_margin(i) > self.start.least_margin(i) for i in ids)
        return better and not self.worse

    @property
    def traded(self) -> tuple[str, ...]:
        """Criteria in which the start has more margin, each on the car that is worst for it."""
        ids = [criterion.id for criterion in self.trial.driven.criteria]
        return tuple(i for i in ids if self.chosen.least_margin(i) <= self.start.least_margin(i))


def tune(
    trial: Trial,
    *,
    seed: int = 0,
    effort: Effort | None = None,
    processes: int | None = None,
    show: Callable[[str, float | None], None] = lambda text, share: None,
    stopped: Callable[[], bool] = lambda: False,
) -> Tuning:
    """Search the free parameters for the largest worst margin.

    Raises:
        BadInputError: the start is unstable on the model or lacks a table that is free, or nothing keeps
            the hard limits.
    """
    space = Space(trial.free.free)
    refuse_missing_tables(trial.start, space.names, trial.free.where)
    refuse_wide_margin(trial.start, trial.free.free, trial.free.where)
    refuse_start(trial)
    with Pool(trial, processes) as pool:
        search = Search(
            pool, space, space.point(values_of(trial.start)), seed, effort or Effort(), show, stopped
        )
        search.execute()
        show("comparing", None)
        if search.ended == "stopped":
            trial, chosen, start = _stopped(pool, search, space)
        else:
            chosen = _chosen(search, space, trial, search.everywhere())
            start = _standing(pool, "start", {}, range(len(trial.draws)))
        others: tuple[Standing, ...] = ()
        sensitivities: dict[str, dict[str, float]] = {}
        if search.ended != "stopped":
            every = range(len(trial.draws))
            others = tuple(_standing(pool, name, values, every) for name, values in _paper(trial).items())
            sensitivities = _sensitivities(pool, space, search.best)
    _refuse_infeasible(chosen, start, trial, search.ended)
    return Tuning(
        trial,
        space,
        chosen,
        start,
        others,
        tuple(search.archive),
        sensitivities,
        search.ended,
        pool.runs,
    )


def _chosen(search: Search, space: Space, trial: Trial, tried: Sequence[Tried]) -> Standing:
    values = space.values(search.best)
    return Standing("tuned", trial.controller(values), values, tuple(tried))


def _stopped(pool: Pool, search: Search, space: Space) -> tuple[Trial, Standing, Standing]:
    """What was best so far and the start, on the cars that the search had got to, numbered anew.

    Where nothing that was tried keeps the hard limits and the start does, the start is the best so far.
    """
    best = search.so_far()
    numbers = [tried.draw for tried in best]
    chosen = _chosen(search, space, pool.trial, best)
    start = _standing(pool, "start", {}, numbers)
    if not chosen.worst.feasible and start.worst.feasible:
        own = {name: value for name, value in values_of(pool.trial.start).items() if name in space.names}
        chosen = Standing("tuned", pool.trial.controller({}), own, start.tried)
    return pool.trial.on(numbers), _renumbered(chosen), _renumbered(start)


def _renumbered(one: Standing) -> Standing:
    return replace(one, tried=tuple(replace(tried, draw=new) for new, tried in enumerate(one.tried)))


def refuse_model(model: Model, where: str) -> None:
    """Refuse a model that no controller should be tuned on.

    Raises:
        BadInputError: it does not explain its own recordings, or it cannot be simulated in a closed loop.
    """
    if model.doubt:
        raise BadInputError(
            f"the model does not explain its recordings: {model.doubt}",
            where=where,
            fix="find the cause with hil diagnose, and tune on the model that it writes",
        )
    if model.kind == "transfer_function":
        raise BadInputError(
            "a 'transfer_function' model has no shaft to load: no plan can be run on it",
            where=where,
            fix="give the physical.toml that hil identify writes beside it",
        )
    refuse_without_vehicle(model, where, "tune")
    refuse_too_stiff(model)


def refuse_start(trial: Trial) -> None:
    """Refuse a start that is unstable on the model.

    Raises:
        BadInputError: names the controller and what to do.
    """
    loop = trial.loops.margins(trial.start, 0)
    if not loop.stable:
        raise BadInputError(
            f"the plan's controller '{trial.driven.file.stem}' is unstable on this model: |S|max "
            f"{loop.sensitivity_peak:.3g} at {loop.sensitivity_peak_hz:.3g} Hz",
            where=str(trial.driven.file),
            fix="give a stable one with --start (hil design makes one); check the model's dead time",
        )


def _refuse_infeasible(chosen: Standing, start: Standing, trial: Trial, ended: str) -> None:
    if all(tried.feasible for tried in chosen.tried):
        return
    if ended == "stopped":
        raise BadInputError(
            f"stopped before a controller was found that keeps the hard limits: the best is beyond them "
            f"{_beyond(chosen, trial)}",
            where=trial.free.where,
            fix="give it longer, relax [limits], narrow [tolerance], or widen [free]",
        )
    own = f"; the start is beyond them {_beyond(start, trial)}" if not start.worst.feasible else ""
    best = _beyond(chosen, trial)
    raise BadInputError(
        f"no controller keeps the hard limits on every car: the best is beyond them {best}{own}",
        where=trial.free.where,
        fix="relax [limits], narrow [tolerance], or widen [free]",
    )


def _beyond(one: Standing, trial: Trial) -> str:
    """On which car it is worst, and what it does not keep there."""
    worst = one.worst
    car = "the model itself" if worst.draw == 0 else f"draw {worst.draw} of {len(trial.draws) - 1}"
    shares = [f"{name} by {-share:.2g} of it" for name, share in worst.limits.items() if share < 0]
    return f"on {car}: {', '.join(shares) or worst.trouble or 'it is unstable'}"


def _standing(pool: Pool, name: str, values: Mapping[str, float], cars: Sequence[int]) -> Standing:
    tried = tuple(pool.tried([(values, number) for number in cars]))
    return Standing(name, pool.trial.controller(values, name), values, tried)


def _paper(trial: Trial) -> dict[str, Mapping[str, float]]:
    """The paper's lead and notch with everything else as the start has it, where they differ from it."""
    wsc, own = trial.start.wsc, values_of(trial.start)
    found: dict[str, Mapping[str, float]] = {}
    for name, part, numbers in (
        ("paper's lead", wsc.lead, PAPER_LEAD),
        ("paper's notch", wsc.notch, PAPER_NOTCH),
    ):
        same = part is not None and all(np.isclose(own[n], v, rtol=1e-3) for n, v in numbers.items())
        if not same:
            found[name] = numbers
    return found


def _sensitivities(pool: Pool, space: Space, best: Array) -> dict[str, dict[str, float]]:
    """Change of each criterion's nominal margin for a step over a parameter's whole range.

    From central differences; from one side where the other is out of bounds or beyond a hard limit.
    """
    points = [best]
    for axis in range(space.size):
        for step in (-SENSITIVITY_STEP, SENSITIVITY_STEP):
            point = best.copy()
            point[axis] = np.clip(point[axis] + step, 0.0, 1.0)
            points.append(point)
    middle, *ends = pool.tried([(space.values(point), 0) for point in points])
    around = [
        (float(point[n // 2]), end) for n, (point, end) in enumerate(zip(points[1:], ends, strict=True))
    ]
    return {
        criterion.id: {
            name: _slope(
                [(float(best[axis]), middle), *around[2 * axis : 2 * axis + 2]],
                criterion.id,
            )
            for axis, name in enumerate(space.names)
        }
        for criterion in pool.trial.driven.criteria
    }


def _slope(near: Sequence[tuple[float, Tried]], criterion: str) -> float:
    """Between the outermost of the middle and both ends where the criterion has a margin."""
    known = sorted((place, tried.margins[criterion]) for place, tried in near if criterion in tried.margins)
    if len(known) < 2 or known[-1][0] == known[0][0]:
        return float("nan")
    return (known[-1][1] - known[0][1]) / (known[-1][0] - known[0][0])
