"""`hil autotune`: a sequence of runs and analyses on a bench, until prediction and run agree."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from hil.cli._autotune_loop import AutotuneLoop
from hil.cli._autotune_stages import MODEL, Told, asked_for
from hil.cli._consent import consent, refuse_nobody
from hil.cli._default_bench import bench_or_own
from hil.cli._interrupts import EXIT_CODE, INTERRUPTS
from hil.cli._named_values import named_numbers
from hil.cli._on_bench import Allowed, predicted_run
from hil.cli._one_run import Runs
from hil.cli._output import console, plain_table, print_json, progress, to_json
from hil.cli._results_folder import ResultsFolder, results_in
from hil.cli._tuning import Asked
from hil.cli.commands.autotune import Autotune
from hil.core.controller import controller_to_toml
from hil.core.digits import share
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.engine.prediction.envelope import envelope_of
from hil.engine.prediction.prediction import predict
from reports import HTML, PDF
from reports.autotune_report import autotune_page
from reports.origin import origin_of
from reports.outputs.autotune import Closing, Decision, closing_summary, closing_verdict
from reports.parts import documents
from test_plans import Plan, Sequence, load_plan, load_sequence

SUMMARY, CONTROLLER = "autotune.json", "controller.toml"
_NAMES = (SUMMARY, CONTROLLER, MODEL, HTML, PDF)


def carry_out(options: Autotune) -> int:
    """Carry the command out; its exit code."""
    if options.resume and options.out is None:
        raise BadInputError(
            "--resume goes with --out", where="--resume", fix="name the directory to continue with --out"
        )
    kept = options.resume or options.overwrite
    told = _told(
        load_sequence(options.sequence),
        options.model,
        options.bench,
        options.envelope or [],
        options.confirm,
        options.operator,
        options.processes,
        kept,
    )
    told = replace(told, resume=options.resume)
    inputs = told.runs.inputs
    with results_in(
        options.out, _NAMES, inputs=inputs, overwrite=kept, default=told.sequence.name, summary=SUMMARY
    ) as place:
        closing = Closing(_asked_for(told), [_consented(told.allowed)])

        def keep() -> None:
            place.write({SUMMARY: _json(closing_summary(closing, [SUMMARY]))}, inputs)
            if not options.json_:
                _tell_newest(closing)

        loop = AutotuneLoop(told, place.folder, closing, keep)
        code = loop.carry_out()
        with progress("the report"):
            summary = _write(loop, told, place)
        if options.json_:
            print_json(summary)
        else:
            _tell(closing, place.folder)
    if code == EXIT_CODE:
        INTERRUPTS.tell()
    return code


def _told(
    sequence: Sequence,
    model: Path,
    bench: str,
    envelope: list[str],
    confirm: str,
    operator: str,
    processes: int | None,
    overwrite: bool,
) -> Told:
    """What is asked for, read, checked, predicted and consented to.

    Raises:
        BadInputError: something of it cannot be used, leaves the envelope, or nobody consents.
    """
    identify = load_plan(sequence.identify_plan)
    bench = bench_or_own(bench, drives=True)
    asked = asked_for(sequence, model, bench)
    for plan in (identify, asked.plan):
        refuse_nobody(plan, asked.bench, confirm)
    allowed = _allowed(sequence, identify, asked, asked.trial.draws[0].model, envelope, confirm)
    files = (*asked.inputs, *(plan.source for plan in (identify, sequence) if plan.source.is_file()))
    runs = allowed.answered(Runs(None, operator, "", "", "", files, overwrite))
    return Told(sequence, model, bench, asked, identify, allowed, runs, processes)


def _allowed(
    sequence: Sequence, identify: Plan, asked: Asked, axle: Model, envelope: list[str], confirm: str
) -> Allowed:
    """An envelope around both plans as the given model predicts them, consented to."""
    stated = named_numbers(envelope, "--envelope")
    accepted = predicted_run(asked.trial, axle, None)
    identified = predict(identify, asked.bench, axle)
    _refuse_unvaried(identify)
    peaks = {name: max(peak, identified.peaks.get(name, 0.0)) for name, peak in accepted.peaks.items()}
    runs = 2 + sequence.rounds * sequence.runs
    once_s, again_s = (float(one.recording.time_s[-1]) for one in (identified, accepted))
    mean_s = (once_s + (runs - 1) * again_s) / runs
    found = envelope_of(asked.bench, peaks, runs, mean_s, stated)
    return Allowed(asked.bench, found, consent((identify, asked.plan), asked.bench, found, confirm))


def _refuse_unvaried(plan: Plan) -> None:
    """Raises:
    BadInputError: nothing of the plan's could be explained.
    """
    if not plan.segments:
        raise BadInputError(
            "the plan for identification has no segment",
            where=f"plan '{plan.name}'",
            fix="add a chirp, a multisine or a step; see the built-in plan short_identification",
        )


def _asked_for(told: Told) -> dict[str, Any]:
    sequence = told.sequence.model_dump(mode="json", exclude={"source", "description", "title"})
    return {"sequence": sequence, "model": str(told.given), **told.allowed.as_json()}


def _consented(allowed: Allowed) -> Decision:
    envelope = allowed.envelope
    who = allowed.name or "no consent needed: the bench is simulated"
    what = f"{who}; {envelope.runs} runs and {envelope.bench_time_s / 60:.3g} min of bench time at most"
    return Decision(
        0, "consent", what, "begin", "each run is predicted first and monitored against the envelope"
    )


def _write(loop: AutotuneLoop, told: Told, place: ResultsFolder) -> dict[str, Any]:
    """Controller, model, summary and report of what is known."""
    closing, files = loop.closing, dict[str, bytes]()
    if closing.best is not None:
        meta = {
            "tuned_for": told.asked.plan.name,
            "in_place_of": told.asked.trial.driven.file.stem,
            "measured_worst_margin": closing.best.worst,
            "as_predicted": closing.agrees,
        }
        named = closing.best.controller.model_copy(update={"name": "autotuned", "meta": meta})
        files[CONTROLLER] = controller_to_toml(named).encode()
    if loop.model != told.given:
        files[MODEL] = loop.model.read_bytes()
    used = {"model": [told.given], "bench": [told.allowed.bench.source], "sequence": [told.sequence.source]}
    page = autotune_page(
        closing,
        loop.shown,
        told.asked.trial.driven.segments,
        told.sequence.title or told.sequence.name,
        told.allowed.told(),
        origin_of(used),
    )
    files |= documents(page)
    summary = closing_summary(closing, sorted([*files, SUMMARY]))
    files[SUMMARY] = _json(summary)
    place.write(files, told.runs.inputs)
    return summary


def _json(summary: dict[str, Any]) -> bytes:
    return (to_json(summary) + "\n").encode()


def _tell_newest(closing: Closing) -> None:
    one = closing.decisions[-1]
    where = f"round {one.round}, {one.stage}" if one.round else one.stage
    text = f"{where}: {one.found}\n  {one.decided}: {one.why}"
    console().print(text, highlight=False, markup=False, soft_wrap=True)


def _tell(closing: Closing, folder: Path) -> None:
    page, best = console(), closing.best
    if best is not None:
        table = plain_table("\nmargins, of the limits")
        table.add_column("criterion", no_wrap=True)
        for name in ("before", "predicted", "measured"):
            table.add_column(name, justify="right")
        for name, measured in best.measured.items():
            before = closing.before_margins.get(name)
            own = "-" if before is None else share(before)
            table.add_row(name, own, share(best.predicted.margins[name]), share(measured))
        page.print(table)
    text = f"{closing_verdict(closing)}\nreport: {folder / HTML}"
    page.print(text, highlight=False, markup=False, soft_wrap=True)
