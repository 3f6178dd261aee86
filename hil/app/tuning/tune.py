"""From a plan's criteria to a controller; then, if asked for, to a bench."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.analysis.diagnosis import Diagnosis
from hil.analysis.tuning import Effort, RefinementBudget, Tuning, tune
from hil.app.feedback import LOGGED, Feedback
from hil.app.interrupts import end_at_second
from hil.app.requests import DiagnoseRequest, TuneRequest
from hil.app.result_file import Outcome
from hil.app.results_folder import ResultsFolder, results_in
from hil.app.run import RunSettings
from hil.app.tuning.bench_runs import FOLDER, Allowed, WireBench, allowed_on
from hil.app.tuning.refinement import (
    DIAGNOSIS,
    FirstRun,
    Refined,
    compare_first_run,
    diagnose_first_run,
    refine_on,
)
from hil.app.tuning.search_files import NAMES, SUMMARY, Search, load_search, write_results
from hil.core.errors import BadInputError, InterruptError
from hil.engine import StopRequest


@dataclass(frozen=True)
class Tuned:
    """What a tuning found, and what came of it on a bench; `stopped`: somebody ended it early."""

    tuning: Tuning
    refined: Refined | None
    first_run: FirstRun | None
    stopped: bool

    @property
    def exit_code(self) -> int:
        """0 if every criterion that hangs on the controller passes where it was last tried.

        So must what is asked of any device.

        On a bench a first run that is the best counts only if it came as predicted.
        """
        if self.refined is None:
            return int(self.tuning.chosen.worst.worst < 0 or bool(self.tuning.failed_checks))
        best, first = self.refined.found.best, self.first_run
        deviates = first is not None and not first.confirmation.agrees
        failed = best is None or best.worst < 0 or (best.number == 1 and deviates)
        return self.refined.exit_code or int(failed)


class Reports:
    """What a tuning reports between its stages; by default nothing."""

    def found(self, tuning: Tuning, folder: Path, drawn: int) -> None:
        """The search has ended; `drawn` cars were wanted, the model itself among them."""

    def diagnosed(self, outcome: Outcome[Diagnosis]) -> None:
        """The first run was not as predicted, and was diagnosed."""


def tune_controller(
    request: TuneRequest, feedback: Feedback = LOGGED, reports: Reports | None = None
) -> Outcome[Tuned]:
    """Search, and write controller, summary and report; then run and refine as asked for.

    Raises:
        BadInputError: something cannot be used, no one consents, or no controller keeps the hard limits.
        InterruptError: it was interrupted before anything worth keeping was found.
    """
    search = load_search(request.search)
    allowed = _allowed(request, search, feedback) if request.refine else None
    if allowed is not None:
        search = search.within(allowed.envelope)
    settings = RunSettings(
        None, request.operator, "", "", "", search.inputs, request.overwrite, feedback=feedback
    )
    with results_in(
        request.out,
        NAMES,
        inputs=search.inputs,
        overwrite=request.overwrite,
        default="tune",
        summary=SUMMARY,
    ) as place:
        stages = _Stages(request, search, settings, place, StopRequest(), reports or Reports())
        found, summary = stages.search_on_model()
        refined = first = None
        if allowed is not None and not stages.stop.times:
            refined, first, summary = stages.refine(found, allowed)
    return Outcome(Tuned(found, refined, first, stages.stop.times > 0), summary, place.folder)


def _allowed(request: TuneRequest, search: Search, feedback: Feedback) -> Allowed:
    axle = search.trial.draws[0].model
    wanted = (request.runs, request.envelope, request.confirm)
    return allowed_on(search.bench, search.trial, axle, *wanted, feedback)


@dataclass(frozen=True)
class _Stages:
    request: TuneRequest
    search: Search
    settings: RunSettings
    place: ResultsFolder
    stop: StopRequest
    reports: Reports

    def search_on_model(self) -> tuple[Tuning, dict[str, Any]]:
        """The best controller on the model, with what was written of it."""
        search, request, stop, feedback = self.search, self.request, self.stop, self.settings.feedback
        progress = feedback.progress(f"tune {search.plan.name}")
        with progress as show, stop.by_signals(), stop.telling(end_at_second(stop)):
            try:
                found = tune(
                    search.trial,
                    seed=request.search.seed,
                    effort=Effort(starts=request.starts),
                    processes=request.processes,
                    show=lambda text, share: show(text, share),
                    stopped=_stopped(stop, request.at_most),
                )
            except BadInputError as error:  # nothing that was tried is worth keeping
                if not stop.times:
                    raise
                feedback.note(str(error))
                raise InterruptError("interrupted") from error
            show("figures and report")
            summary = write_results(search, found, self.place.write)
        self.reports.found(found, self.place.folder, len(search.trial.draws))
        return found, summary

    def refine(self, found: Tuning, allowed: Allowed) -> tuple[Refined, FirstRun | None, dict[str, Any]]:
        """Runs that refine it; the first is diagnosed if it is not as predicted."""
        search, request, stop, feedback = self.search, self.request, self.stop, self.settings.feedback
        axle, place = search.trial.draws[0].model, self.place.folder / FOLDER
        wire = WireBench(request.search.plan, search.trial, axle, allowed, self.settings, place)
        with stop.by_signals():
            budget = RefinementBudget(allowed.envelope.runs)
            refined = refine_on(wire, found, budget, request.processes, feedback, lambda: stop.times > 0)
            first = compare_first_run(refined, request.differ / 100, lambda: self._diagnose(wire))
            return refined, first, write_results(search, found, self.place.write, refined, first)

    def _diagnose(self, wire: WireBench) -> str:
        wanted = DiagnoseRequest(
            model=self.request.search.model,
            recordings=[],
            out=self.place.folder / DIAGNOSIS,
            overwrite=self.settings.overwrite,
        )
        return diagnose_first_run(wire, wanted, self.settings.feedback, self.reports.diagnosed)


def _stopped(stop: StopRequest, at_most_min: float | None) -> Callable[[], bool]:
    end_s = float("inf") if at_most_min is None else time.monotonic() + 60 * at_most_min
    return lambda: stop.times > 0 or time.monotonic() > end_s
