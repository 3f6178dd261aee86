"""What a tuning searches on, and what it writes: for a tuning alone and as a stage of autotune."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hil.analysis.tuning import (
    KEPT,
    Driven,
    Free,
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
)
from hil.app.requests import SearchRequest
from hil.app.result_file import json_file
from hil.app.tuning.refinement import FirstRun, Refined
from hil.core.controller import Controller, load_controller
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.files.toml_file import toml_text
from hil.core.model import load_model
from hil.engine import BenchFile, load_bench
from hil.engine.prediction.batch_prediction import BatchPrediction
from hil.engine.prediction.forecast import Envelope
from reports import HTML, PDF
from reports.origin import origin_of
from reports.outputs.tuning import CONTROLLER, FREE, output_files, summary_of
from reports.parts import documents
from reports.refinement import refined_page
from reports.tuning_report import Shown, tuning_page
from test_plans import Plan, load_plan

SUMMARY = "tune.json"
NAMES = (CONTROLLER, FREE, SUMMARY, HTML, PDF)


@dataclass(frozen=True)
class Search:
    """A search that was read and checked; `facts` stand in its summary."""

    plan: Plan
    bench: BenchFile
    free_text: str
    trial: Trial
    inputs: tuple[Path, ...]
    facts: dict[str, Any]

    def within(self, envelope: Envelope) -> Search:
        """The same, of controllers alone whose runs stay within an envelope."""
        execute = self.trial.execute
        assert isinstance(execute, BatchPrediction)
        execute = replace(execute, channels=execute.channels | envelope.largest.keys())
        return replace(self, trial=replace(self.trial, execute=execute, envelope=envelope.largest))


def load_search(request: SearchRequest) -> Search:
    """Read and check all that a search needs.

    Raises:
        BadInputError: plan, model, bench, controller or free parameters cannot be used together.
    """
    plan, bench, axle = load_plan(request.plan), load_bench(request.bench), load_model(request.model)
    refuse_model(axle, str(request.model))
    wanted = _let_go(read_free(request.free), request.may_worsen)
    refuse_unknown_weights(wanted, plan)
    driven = driven_by(plan, request.controller)
    start_file = request.start or driven.file
    start = load_controller(start_file)
    _refuse_beyond_bench(wanted, start, bench)
    cars = draws_of(axle, wanted.tolerance, request.draws, request.seed)
    trial = Trial(
        plan,
        driven,
        wanted,
        start,
        cars,
        SpeedLoops([car.model for car in cars], start.sample_time_s),
        _runs(plan, bench, driven, wanted),
    )
    named = (request.free, request.start, plan.source)
    inputs = [request.model, bench.source, *(path for path in named if path is not None)]
    facts = {
        "plan": plan.name,
        "model": str(request.model),
        "bench": bench.name,
        "start": str(start_file),
        "draws": request.draws,
        "seed": request.seed,
    }
    text = shipped_free() if request.free is None else toml_text(request.free)
    return Search(plan, bench, text, trial, tuple(path for path in inputs if path.is_file()), facts)


def _let_go(free: Free, names: tuple[str, ...]) -> Free:
    """What is free, with more that may get worse.

    Raises:
        BadInputError: nothing of that name is kept.
    """
    for name in names:
        if name not in KEPT:
            raise BadInputError(
                f"'{name}' is not one of what a tuning keeps",
                where="--may-worsen",
                fix=did_you_mean(name, KEPT),
            )
    more = tuple(dict.fromkeys((*free.keep.may_worsen, *names)))
    return free.model_copy(update={"keep": free.keep.model_copy(update={"may_worsen": more})})


def _runs(plan: Plan, bench: BenchFile, driven: Driven, free: Free) -> BatchPrediction:
    criteria = (*driven.criteria, *plan.device_criteria)
    return BatchPrediction(plan, bench, driven.file, channels_needed(criteria, free))


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


def write_results(
    search: Search,
    found: Tuning,
    write: Callable[..., None],
    refinement: Refined | None = None,
    first_run: FirstRun | None = None,
) -> dict[str, Any]:
    """Write all results of a search and of the runs that refined it; the content of tune.json."""
    shown = []
    for one in found.shown:
        predicted = search.trial.execute(found.trial.draws[0].model, one.controller, 0.0, 0, whole=True)
        shown.append(Shown(one.name, predicted.recording, predicted.segments))
    if refinement is not None and refinement.shown is not None:
        shown.insert(1, refinement.shown)
    best = None if refinement is None else refinement.found.best
    files = output_files(found, search.free_text, best)
    listed = sorted([*files, SUMMARY, HTML, PDF])
    summary = summary_of(found, shown[0].segments, search.facts, listed)
    if first_run is not None:
        summary["confirmed"] = first_run.as_json()
    if refinement is not None:
        summary["refined"] = refinement.as_json()
    model = Path(search.facts["model"])
    used = {"model": [model], "bench": [search.bench.source], "controller": [Path(search.facts["start"])]}
    confirmed = None if first_run is None else first_run.confirmation
    page = tuning_page(found, shown, search.plan.name, origin_of(used), confirmed)
    if refinement is not None:
        page = refined_page(page, refinement.found, refinement.allowed.in_words())
    files |= documents(page)
    files[SUMMARY] = json_file(summary)
    write(files, search.inputs)
    return summary
