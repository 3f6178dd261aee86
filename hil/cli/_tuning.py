"""What a tuning is told, and what it writes: for `hil tune` and for the loop that has it as a part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.analysis.tuning import (
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
from hil.cli._output import to_json
from hil.cli._refine_on_bench import Refined
from hil.cli._then_run import Ran, as_json
from hil.core.controller import Controller, load_controller
from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.toml_file import toml_text
from hil.engine import BenchFile, load_bench
from hil.engine.prediction.batch_prediction import BatchPrediction
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
class Asked:
    """What the command was told, read and checked."""

    plan: Plan
    bench: BenchFile
    free_text: str
    trial: Trial
    inputs: tuple[Path, ...]
    told: dict[str, Any]


def asked_of(
    plan: str,
    model: Path,
    free: Path | None,
    controller: str,
    start: Path | None,
    draws: int,
    seed: int,
    bench: str,
) -> Asked:
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
    return Asked(loaded, file, text, trial, tuple(path for path in inputs if path.is_file()), told)


def _runs(plan: Plan, bench: BenchFile, driven: Driven, free: Free) -> BatchPrediction:
    metrics = tuple(criterion.metric for criterion in driven.criteria)
    return BatchPrediction(plan, bench, driven.file, channels_needed(metrics, free))


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
    asked: Asked,
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
    page = tuning_page(found, shown, asked.plan.name, origin_of(used), confirmed)
    if refinement is not None:
        page = refined_page(page, refinement.found, refinement.allowed.told())
    files |= documents(page)
    files[SUMMARY] = (to_json(summary) + "\n").encode()
    write(files, asked.inputs)
    return summary
