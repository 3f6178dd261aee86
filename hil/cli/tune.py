"""`hil tune`: from a plan's criteria to a controller."""

from __future__ import annotations

import time
from collections.abc import Callable

from hil.analysis.tuning import Effort, RefinementBudget, Tuning, tune
from hil.cli._default_bench import bench_or_own
from hil.cli._interrupts import EXIT_CODE, INTERRUPTS
from hil.cli._on_bench import FOLDER, Wanted, WireBench, allowed_on
from hil.cli._one_run import Runs
from hil.cli._output import print_json, progress
from hil.cli._refine_on_bench import Refined, refined
from hil.cli._results_folder import results_in
from hil.cli._second_interrupt import at_once
from hil.cli._streams import complain
from hil.cli._then_run import OnTheWire, Ran, refuse_unasked, tell
from hil.cli._then_run import then_run as run_tuned
from hil.cli._tuning import NAMES, SUMMARY, asked_of, write_results
from hil.cli.commands.tune import Tune
from hil.core.errors import BadInputError
from hil.engine import StopRequest
from reports.outputs.tuning import text_of


def carry_out(options: Tune) -> int:
    """Carry the command out; its exit code."""
    wanted = Wanted(options.on_bench, options.runs, options.envelope or [], options.confirm)
    _refuse_together(wanted, options.bench, then_run=options.then_run)
    used = wanted.bench or bench_or_own(options.bench, options.plan, drives=options.then_run)
    asked = asked_of(
        options.plan,
        options.model,
        options.free,
        options.controller,
        options.start,
        options.draws,
        options.seed,
        used,
    )
    if options.then_run:
        refuse_unasked(asked.plan)
    axle = asked.trial.draws[0].model
    allowed = allowed_on(wanted, asked.bench, asked.trial, axle) if wanted.bench else None
    carried = Runs(None, options.operator, "", "", "", asked.inputs, options.overwrite)
    stop, ran, refinement = StopRequest(), None, None
    with results_in(
        options.out, NAMES, inputs=asked.inputs, overwrite=options.overwrite, default="tune", summary=SUMMARY
    ) as place:
        with progress(f"tune {asked.plan.name}") as show, stop.by_signals(), stop.telling(at_once(stop)):
            try:
                found = tune(
                    asked.trial,
                    seed=options.seed,
                    effort=Effort(starts=options.starts),
                    processes=options.processes,
                    show=lambda text, share: show(text, share),
                    stopped=_stopped(stop, options.at_most),
                )
            except BadInputError as error:  # nothing that was tried is worth keeping
                if not stop.times:
                    raise
                complain("note", str(error))
                INTERRUPTS.tell()
                return EXIT_CODE
            show("figures and report")
            summary = write_results(asked, found, place.write)
        if not options.json_:
            print(text_of(found, str(place.folder)))
        tried, every = len(found.trial.draws), len(asked.trial.draws)
        if tried < every:
            complain(
                "note", f"stopped: compared on {tried} of {every} vehicles, those that the search had used"
            )
        if options.then_run and not stop.times:
            wire = OnTheWire(asked.bench, options.differ / 100, carried)
            ran = run_tuned(found, options.plan, place.folder, wire, options.model)
            summary = write_results(asked, found, place.write, ran)
        if allowed is not None and not stop.times:
            on = WireBench(options.plan, asked.trial, axle, allowed, carried, place.folder / FOLDER)
            with stop.by_signals():
                budget = RefinementBudget(allowed.envelope.runs)
                refinement = refined(found, on, budget, options.processes, lambda: stop.times > 0)
                summary = write_results(asked, found, place.write, refinement=refinement)
        if options.json_:
            print_json(summary)
        elif ran is not None:
            tell(ran)
        elif refinement is not None:
            refinement.tell()
    code = _exit_code(found, ran, refinement)
    if stop.times or code == EXIT_CODE:
        INTERRUPTS.tell()
        return EXIT_CODE
    return code


def _refuse_together(wanted: Wanted, bench: str, *, then_run: bool) -> None:
    """Raises:
    BadInputError: an option without the one that it goes with, or beside one that it does not go with.
    """
    wanted.refuse_alone()
    if wanted.bench and (bench or then_run):
        option = "--bench" if bench else "--then-run"
        raise BadInputError(f"{option} does not go with --on-bench", where=option, fix="leave it out")


def _exit_code(found: Tuning, ran: Ran | None, refinement: Refined | None) -> int:
    if refinement is not None:
        best = refinement.found.best
        return refinement.exit_code or int(best is None or best.worst < 0)
    if ran is None:
        return int(found.chosen.worst.worst < 0)
    if ran.exit_code > 1:
        return ran.exit_code
    return int(not (ran.confirmation.agrees and ran.confirmation.passed))


def _stopped(stop: StopRequest, at_most_min: float | None) -> Callable[[], bool]:
    end_s = float("inf") if at_most_min is None else time.monotonic() + 60 * at_most_min
    return lambda: stop.times > 0 or time.monotonic() > end_s
