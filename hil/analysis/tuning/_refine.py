"""A tuned controller refined where it is measured: few runs, each within a trust region around the best.

Predicted margins are corrected by what the runs have shown (`_trust_step`); the region grows where a run
comes out as expected and shrinks where it does not (A. R. Conn, N. I. M. Gould, Ph. L. Toint, "Trust-Region
Methods", SIAM 2000, ch. 6). The best is always one that was measured.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt

from hil.analysis.tuning._confirmed import Confirmation, confirmation
from hil.analysis.tuning._parameters import Space
from hil.analysis.tuning._pool import Pool
from hil.analysis.tuning._trial import Trial, Tried
from hil.analysis.tuning._trust_step import Correction, Promise, TrustStep, correction_of
from hil.core.controller import Controller
from hil.core.errors.wording import share as percent
from hil.core.result import CriterionResult

Array = npt.NDArray[np.float64]
Decision = Literal["first", "taken", "left", "refused", "failed"]

#: Radii of the trust region, in ranges of the parameters: first, largest, and the least that is worth a run.
FIRST_RADIUS, LARGEST_RADIUS, LEAST_RADIUS = 0.15, 0.4, 0.02
#: Gained over expected: a run below the first of these is not as expected, one above the second is.
AS_BAD, AS_GOOD = 0.25, 0.75
_GROW, _SHRINK = 1.6, 0.5


@dataclass(frozen=True)
class Measured:
    """What a run came to: criteria of the whole plan; or why there is nothing that could be judged."""

    criteria: tuple[CriterionResult, ...] = ()
    trouble: str = ""


class Bench(Protocol):
    """Where controllers are measured."""

    def refused(self, controller: Controller) -> str:
        """Why a run with it must not be made, as predicted; '' if it may."""
        ...

    def run(self, controller: Controller, number: int) -> Measured:
        """Carry the plan out with it, the `number`th time."""
        ...


@dataclass(frozen=True)
class RefinedRun:
    """One step: what was tried, what it promised and came to, and what was made of it.

    `predicted` is what it comes to on the model itself. Margins are weighted, by criterion: `expected` as
    earlier runs correct the prediction, `measured` (empty where nothing was run). `radius` is that of the
    region which it was chosen from.
    """

    number: int
    values: Mapping[str, float]
    controller: Controller
    radius: float
    predicted: Tried
    expected: Mapping[str, float]
    measured: Mapping[str, float]
    criteria: tuple[CriterionResult, ...]
    decision: Decision
    reason: str

    @property
    def worst(self) -> float:
        """The least measured margin."""
        return min(self.measured.values())

    def beside_prediction(self, allowed: float) -> Confirmation:
        """Predicted and measured criteria; `allowed` is the largest distance, a share of a limit."""
        return confirmation(self.predicted.criteria, self.criteria, allowed)


@dataclass(frozen=True)
class Refinement:
    """All runs in order, the best of them (None if the first already failed), and why there was no other."""

    runs: tuple[RefinedRun, ...]
    best: RefinedRun | None
    ended: str


@dataclass(frozen=True)
class RefinementBudget:
    """How long a refinement goes on.

    Attributes:
        runs: at most.
        least_gain: of the worst margin; less is no growth.
        stop_beyond: a first run of which a criterion is further than this share of its limit from what was
            predicted is the last; None: it goes on with what that run has shown.
    """

    runs: int = 20
    least_gain: float = 0.002
    stop_beyond: float | None = None


def refine(
    trial: Trial,
    space: Space,
    start: Array,
    bench: Bench,
    *,
    budget: RefinementBudget | None = None,
    processes: int | None = None,
    show: Callable[[str, float | None], None] = lambda text, share: None,
    stopped: Callable[[], bool] = lambda: False,
) -> Refinement:
    """Refine what lies at `start` of the unit cube of `space` by runs on `bench`.

    Args:
        stopped: asked between predictions and between runs; what was measured is kept.
    """
    with Pool(trial, processes) as pool:
        step = TrustStep(pool, space, start, stopped)
        return _Refining(trial, space, bench, budget or RefinementBudget(), step, show, stopped).execute(
            start
        )


class _Refining:
    def __init__(
        self,
        trial: Trial,
        space: Space,
        bench: Bench,
        budget: RefinementBudget,
        step: TrustStep,
        show: Callable[[str, float | None], None],
        stopped: Callable[[], bool],
    ) -> None:
        self._trial, self._space, self._bench, self._budget = trial, space, bench, budget
        self._step, self._show, self._stopped = step, show, stopped
        self._runs: list[RefinedRun] = []
        self._points: list[Array] = []
        self._apart: list[Array] = []
        self._best = 0
        self._radius, self._in_vain = FIRST_RADIUS, 0

    def execute(self, start: Array) -> Refinement:
        names = [criterion.id for criterion in self._trial.driven.criteria]
        nothing = Correction(start, np.zeros(len(names)), np.zeros((len(names), start.size)))
        first = self._step.promise(start, nothing)
        if first is None:
            return Refinement((), None, "the start exceeds a hard limit on the nominal model")
        ended = self._carried_out(first, self._first_decided) or self._first_agrees()
        while not ended:
            ended = self._next()
        return Refinement(tuple(self._runs), self._runs[self._best] if self._points else None, ended)

    def _first_agrees(self) -> str:
        """Why a first run that is not as predicted is the last, if it is to be."""
        allowed = self._budget.stop_beyond
        if allowed is None or self._runs[0].beside_prediction(allowed).agrees:
            return ""
        return f"the first run deviates from its prediction by more than {100 * allowed:g} % of a limit"

    def _next(self) -> str:
        """One more run; why there is none, or no other after it."""
        if self._stopped():
            return "stopped"
        if len(self._runs) >= self._budget.runs:
            return "all runs are complete"
        self._show(f"run {len(self._runs) + 1}: choosing parameters", len(self._runs) / self._budget.runs)
        correction = correction_of(self._points, self._apart, self._best)
        centre = self._step.promise(self._points[self._best], correction)
        assert centre is not None, "the same gain was predicted before"
        found = self._step.best(centre, correction, self._radius)
        if self._stopped():
            return "stopped"
        gain = found.worst - self._runs[self._best].worst
        if gain < self._budget.least_gain:
            return f"no further improvement predicted ({percent(max(gain, 0.0), 2)} of a limit)"
        return self._carried_out(found, self._decided)

    def _carried_out(self, promise: Promise, decide: Callable[[RefinedRun], tuple[Decision, str]]) -> str:
        """Run it; why there can be no other, '' if there can."""
        number = len(self._runs) + 1
        values = self._space.values(promise.point)
        controller = self._trial.controller(values, f"refined_{number}")
        run = RefinedRun(
            number,
            values,
            controller,
            self._radius,
            promise.tried,
            promise.corrected.margins,
            {},
            (),
            "refused",
            self._bench.refused(controller),
        )
        if not run.reason:
            self._show(f"run {number} of at most {self._budget.runs}", (number - 1) / self._budget.runs)
            came = self._bench.run(controller, number)
            run = replace(run, measured=self._trial.margins_of(came.criteria), criteria=came.criteria)
            if came.trouble or len(run.measured) < len(run.expected):
                why = came.trouble or "some criteria that depend on the controller were not evaluated"
                run = replace(run, measured={}, decision="failed", reason=why)
        if not run.measured:
            self._runs.append(run)
            return run.reason
        self._apart.append(_numbers(run.measured) - _numbers(run.predicted.margins))
        self._points.append(promise.point)
        decision, reason = decide(run)
        self._runs.append(replace(run, decision=decision, reason=reason))
        if decision != "left":
            self._best = len(self._points) - 1
        if self._radius < LEAST_RADIUS:
            return "the trust region has reached its minimum size"
        return "two consecutive runs gave no improvement" if self._in_vain > 1 else ""

    def _first_decided(self, run: RefinedRun) -> tuple[Decision, str]:
        return "first", f"the prediction; worst margin {percent(run.worst, 2)}"

    def _decided(self, run: RefinedRun) -> tuple[Decision, str]:
        """Whether it is the new centre, and how large the region is from now on."""
        before = self._runs[self._best].worst
        gain, expected = run.worst - before, min(run.expected.values()) - before
        share = gain / expected
        words = f"gained {percent(gain, 2)}, expected {percent(expected, 2)}"
        self._in_vain = 0 if gain >= self._budget.least_gain else self._in_vain + 1
        if share >= AS_GOOD:
            self._radius = min(_GROW * self._radius, LARGEST_RADIUS)
            words += ": as expected, the region grows"
        elif share < AS_BAD:
            self._radius *= _SHRINK
            words += ": not as expected, the region shrinks"
        return ("taken" if gain > 0 else "left"), words


def _numbers(margins: Mapping[str, float]) -> Array:
    return np.array(list(margins.values()))
