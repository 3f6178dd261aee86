"""`hil tune`: from a plan's criteria to a controller."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.analysis.tuning import (
    Driven,
    Effort,
    Free,
    Patience,
    SpeedLoops,
    Trial,
    Tuning,
    channels_needed,
    draws_of,
    driven_by,
    read_free,
    refuse_model,
    refuse_unknown_weights,
    shipped_free,
    tune,
)
from hil.cli._interrupts import EXIT_CODE, INTERRUPTS
from hil.cli._on_bench import FOLDER, Wanted, WireBench, allowed_on
from hil.cli._one_run import Runs
from hil.cli._output import print_json, progress, to_json
from hil.cli._place import results_in
from hil.cli._refine_on_bench import Refined, refined
from hil.cli._then_run import OnTheWire, Ran, as_json, refuse_unasked, tell
from hil.cli._then_run import then_run as run_tuned
from hil.core.controller import Controller, load_controller
from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.toml_file import toml_text
from hil.engine import DEFAULT_BENCH, BenchFile, StopRequest, load_bench
from hil.engine.trial_runs import TrialRuns
from reports import HTML, PDF
from reports.origin import origin_of
from reports.outputs.tuning import CONTROLLER, FREE, output_files, summary_of, text_of
from reports.parts import documents
from reports.refinement import refined_page
from reports.tuning_report import Shown, tuning_page
from test_plans import Plan, load_plan

SUMMARY = "tune.json"
_BETWEEN = 0.4  # generations on the worst cars for each of those on the model itself


def carry_out(
    *,
    plan: str,
    model: Path,
    out: Path | None,
    free: Path | None,
    controller: str,
    start: Path | None,
    draws: int,
    seed: int,
    generations: int,
    at_most: float | None,
    processes: int | None,
    bench: str,
    then_run: bool,
    differ: float,
    wanted: Wanted,
    operator: str,
    overwrite: bool,
    json_: bool,
) -> int:
    """Carry the command out; its exit code."""
    wanted.refuse_alone()
    if wanted.bench and (bench or then_run):
        option = "--bench" if bench else "--then-run"
        raise BadInputError(f"{option} does not go with --on-bench", where=option, fix="leave it out")
    asked = _asked(plan, model, free, controller, start, draws, seed, wanted.bench or bench or DEFAULT_BENCH)
    if then_run:
        refuse_unasked(asked.plan)
    axle = asked.trial.draws[0].model
    allowed = allowed_on(wanted, asked.bench, asked.trial, axle) if wanted.bench else None
    stop, ran, refinement = StopRequest(), None, None
    names = (CONTROLLER, FREE, SUMMARY, HTML, PDF)
    with results_in(
        out, names, inputs=asked.inputs, overwrite=overwrite, default="tune", summary=SUMMARY
    ) as place:
        with progress(f"tune {asked.plan.name}") as show, stop.by_signals():
            found = tune(
                asked.trial,
                seed=seed,
                effort=Effort(far=generations, between=max(1, round(_BETWEEN * generations))),
                processes=processes,
                show=lambda text, share: show(text, share),
                stopped=_stopped(stop, at_most),
            )
            show("figures and report")
            summary = _write(asked, found, place.write)
        if then_run and not stop.times:
            if not json_:
                print(text_of(found, str(place.folder)))
            runs = Runs(None, operator, "", "", "", asked.inputs, overwrite)
            ran = run_tuned(found, plan, place.folder, OnTheWire(asked.bench, differ / 100, runs), model)
            summary = _write(asked, found, place.write, ran)
        if allowed is not None and not stop.times:
            runs = Runs(None, operator, "", "", "", asked.inputs, overwrite)
            patience = Patience(allowed.envelope.runs)
            wire = WireBench(plan, asked.trial, axle, allowed, runs, place.folder / FOLDER)
            with stop.by_signals():
                refinement = refined(found, wire, patience, processes, lambda: stop.times > 0)
                summary = _write(asked, found, place.write, refinement=refinement)
        if json_:
            print_json(summary)
        elif ran is not None:
            tell(ran)
        elif refinement is not None:
            print(text_of(found, str(place.folder)))
            refinement.tell()
        else:
            print(text_of(found, str(place.folder)))
    if stop.times or (refinement is not None and refinement.exit_code == EXIT_CODE):
        INTERRUPTS.tell()
        return EXIT_CODE
    if refinement is not None:
        best = refinement.found.best
        return refinement.exit_code or int(best is None or best.worst < 0)
    if ran is not None:
        return (
            ran.exit_code
            if ran.exit_code > 1
            else int(not (ran.confirmation.agrees and ran.confirmation.passed))
        )
    return 0 if found.chosen.worst.worst >= 0 else 1


def _stopped(stop: StopRequest, at_most_min: float | None) -> Callable[[], bool]:
    end_s = float("inf") if at_most_min is None else time.monotonic() + 60 * at_most_min
    return lambda: stop.times > 0 or time.monotonic() > end_s


@dataclass(frozen=True)
class _Asked:
    """What the command was told, read and checked."""

    plan: Plan
    bench: BenchFile
    free_text: str
    trial: Trial
    inputs: tuple[Path, ...]
    told: dict[str, Any]


def _asked(
    plan: str,
    model: Path,
    free: Path | None,
    controller: str,
    start: Path | None,
    draws: int,
    seed: int,
    bench: str,
) -> _Asked:
    loaded, file, axle = load_plan(plan), load_bench(bench), load_model(model)
    refuse_model(axle, str(model))
    wanted = read_free(free)
    refuse_unknown_weights(wanted, loaded)
    driven = driven_by(loaded, controller)
    begun = load_controller(start or driven.file)
    _refuse_beyond_bench(wanted, begun, file)
    cars = draws_of(axle, wanted.tolerance, draws, seed)
    trial = Trial(
        loaded,
        driven,
        wanted,
        begun,
        cars,
        SpeedLoops([car.model for car in cars], begun.sample_time_s),
        _runs(loaded, file, driven, wanted),
    )
    inputs = [model, file.source, *(path for path in (free, start, loaded.source) if path is not None)]
    told = {
        "plan": loaded.name,
        "model": str(model),
        "bench": file.name,
        "start": str(start or driven.file),
        "draws": draws,
        "seed": seed,
    }
    text = shipped_free() if free is None else toml_text(free)
    return _Asked(loaded, file, text, trial, tuple(path for path in inputs if path.is_file()), told)


def _runs(plan: Plan, bench: BenchFile, driven: Driven, free: Free) -> TrialRuns:
    metrics = tuple(criterion.metric for criterion in driven.criteria)
    return TrialRuns(plan, bench, driven.file, channels_needed(metrics, free))


def _refuse_beyond_bench(free: Free, start: Controller, bench: BenchFile) -> None:
    """Refuse torque limits that contradict the bench's."""
    limit = bench.limits.motor_torque_nm
    highest = free.free.get("torque_limit_nm", (0.0, start.torque_limit_nm))[1]
    if highest > limit:
        raise BadInputError(
            f"the torque limit may reach {highest:g} N m, the bench '{bench.name}' allows {limit:g} N m",
            where=free.where,
            fix="lower free.torque_limit_nm, or the start's torque_limit_nm",
        )


def _write(
    asked: _Asked,
    found: Tuning,
    write: Callable[..., None],
    ran: Ran | None = None,
    refinement: Refined | None = None,
) -> dict[str, Any]:
    """Everything of the results; gives the content of tune.json."""
    shown = []
    for one in found.shown:
        predicted = asked.trial.carry_out(found.trial.draws[0].model, one.controller, 0.0, 0, whole=True)
        shown.append(Shown(one.name, predicted.recording, predicted.segments))
    if ran is not None:
        shown.insert(1, ran.shown)
    if refinement is not None and refinement.shown is not None:
        shown.insert(1, refinement.shown)
    came = None if refinement is None else refinement.found
    files = output_files(found, asked.free_text, None if came is None else came.best)
    listed = sorted([*files, SUMMARY, HTML, PDF])
    summary = summary_of(found, shown[0].segments, asked.told, listed)
    if ran is not None:
        summary["confirmed"] = as_json(ran)
    if refinement is not None:
        summary["refined"] = refinement.as_json()
    model = Path(asked.told["model"])
    used = {"model": [model], "bench": [asked.bench.source], "controller": [Path(asked.told["start"])]}
    confirmed = None if ran is None else ran.confirmation
    page = tuning_page(found, shown, files, asked.plan.name, origin_of(used), confirmed)
    if refinement is not None:
        page = refined_page(page, refinement.found, refinement.consented)
    files |= documents(page)
    files[SUMMARY] = (to_json(summary) + "\n").encode()
    write(files, asked.inputs)
    return summary
