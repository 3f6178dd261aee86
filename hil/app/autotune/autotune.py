"""A sequence of runs and analyses on a bench, until prediction and run agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hil.app.autotune.loop import AutotuneLoop
from hil.app.autotune.stages import MODEL, LoopSettings, search_for
from hil.app.consent import consent, refuse_nobody
from hil.app.feedback import LOGGED, Feedback
from hil.app.requests import AutotuneRequest
from hil.app.result_file import Outcome, json_file
from hil.app.results_folder import ResultsFolder, results_in
from hil.app.run import RunSettings
from hil.app.tuning.bench_runs import Allowed, predicted_run
from hil.app.tuning.search_files import Search
from hil.core.controller import controller_to_toml
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.engine.prediction.forecast import Envelope, envelope_of
from hil.engine.prediction.prediction import predict
from reports import HTML, PDF
from reports.autotune_report import autotune_page
from reports.origin import origin_of
from reports.outputs.autotune import Closing, Decision, closing_summary
from reports.parts import documents
from test_plans import Plan, Sequence, load_plan, load_sequence

SUMMARY, CONTROLLER = "autotune.json", "controller.toml"
_NAMES = (SUMMARY, CONTROLLER, MODEL, HTML, PDF)


@dataclass(frozen=True)
class Autotuned:
    """What the loop came to; `exit_code` is 0 if it ended content."""

    closing: Closing
    exit_code: int


def autotune(
    request: AutotuneRequest,
    feedback: Feedback = LOGGED,
    report_decision: Callable[[Decision], None] = lambda decision: None,
) -> Outcome[Autotuned]:
    """Carry the sequence out, and write controller, model, summary and report.

    Args:
        report_decision: called with each decision that was taken.

    Raises:
        BadInputError: something cannot be used, a plan leaves the envelope, or no one consents.
    """
    settings = _settings(request, load_sequence(request.sequence), feedback)
    inputs = settings.runs.inputs
    with results_in(
        request.out,
        _NAMES,
        inputs=inputs,
        overwrite=settings.runs.overwrite,
        default=settings.sequence.name,
        summary=SUMMARY,
    ) as place:
        closing = Closing(_as_wanted(settings), [_consented(settings.allowed)])

        def keep() -> None:
            place.write({SUMMARY: json_file(closing_summary(closing, [SUMMARY]))}, inputs)
            report_decision(closing.decisions[-1])

        loop = AutotuneLoop(settings, place.folder, closing, keep)
        code = loop.execute()
        with feedback.progress("the report"):
            summary = _write(loop, settings, place)
    return Outcome(Autotuned(closing, code), summary, place.folder)


def proposed_envelope(request: AutotuneRequest) -> Envelope:
    """What a sequence would ask of its bench, before anybody consents to it; nothing moves.

    Raises:
        BadInputError: something cannot be used, or a plan leaves the envelope.
    """
    sequence = load_sequence(request.sequence)
    search = search_for(sequence, request.model, request.bench)
    return _envelope(request, sequence, load_plan(sequence.identify_plan), search)


def _settings(request: AutotuneRequest, sequence: Sequence, feedback: Feedback) -> LoopSettings:
    """What is wanted, read, checked, predicted and consented to."""
    identify = load_plan(sequence.identify_plan)
    search = search_for(sequence, request.model, request.bench)
    for plan in (identify, search.plan):
        refuse_nobody(plan, search.bench, request.confirm, feedback)
    allowed = _allowed(request, sequence, identify, search, feedback)
    files = (*search.inputs, *(plan.source for plan in (identify, sequence) if plan.source.is_file()))
    overwrite = request.resume or request.overwrite
    runs = RunSettings(None, request.operator, "", "", "", files, overwrite, feedback=feedback)
    return LoopSettings(
        sequence,
        request.model,
        request.bench,
        search,
        identify,
        allowed,
        allowed.answered(runs),
        request.processes,
        request.resume,
    )


def _allowed(
    request: AutotuneRequest, sequence: Sequence, identify: Plan, search: Search, feedback: Feedback
) -> Allowed:
    """An envelope around both plans as the given model predicts them, consented to."""
    found = _envelope(request, sequence, identify, search)
    plans = (identify, search.plan)
    return Allowed(search.bench, found, consent(plans, search.bench, found, request.confirm, feedback))


def _envelope(request: AutotuneRequest, sequence: Sequence, identify: Plan, search: Search) -> Envelope:
    axle: Model = search.trial.draws[0].model
    accepted = predicted_run(search.trial, axle, None)
    identified = predict(identify, search.bench, axle)
    _refuse_unvaried(identify)
    peaks = {name: max(peak, identified.peaks.get(name, 0.0)) for name, peak in accepted.peaks.items()}
    runs = 2 + sequence.rounds * sequence.runs
    once_s, again_s = (float(one.recording.time_s[-1]) for one in (identified, accepted))
    mean_s = (once_s + (runs - 1) * again_s) / runs
    return envelope_of(search.bench, peaks, runs, mean_s, dict(request.envelope))


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


def _as_wanted(settings: LoopSettings) -> dict[str, Any]:
    sequence = settings.sequence.model_dump(mode="json", exclude={"source", "description", "title"})
    return {"sequence": sequence, "model": str(settings.given), **settings.allowed.as_json()}


def _consented(allowed: Allowed) -> Decision:
    envelope = allowed.envelope
    who = allowed.name or "no consent needed: the bench is simulated"
    what = f"{who}; {envelope.runs} runs and {envelope.bench_time_s / 60:.3g} min of bench time at most"
    return Decision(
        0, "consent", what, "begin", "each run is predicted first and monitored against the envelope"
    )


def _write(loop: AutotuneLoop, settings: LoopSettings, place: ResultsFolder) -> dict[str, Any]:
    """Controller, model, summary and report of what is known."""
    closing, files = loop.closing, dict[str, bytes]()
    if closing.best is not None:
        meta = {
            "tuned_for": settings.search.plan.name,
            "in_place_of": settings.search.trial.driven.file.stem,
            "measured_worst_margin": closing.best.worst,
            "as_predicted": closing.agrees,
        }
        named = closing.best.controller.model_copy(update={"name": "autotuned", "meta": meta})
        files[CONTROLLER] = controller_to_toml(named).encode()
    if loop.model != settings.given:
        files[MODEL] = loop.model.read_bytes()
    used = {
        "model": [settings.given],
        "bench": [settings.allowed.bench.source],
        "sequence": [settings.sequence.source],
    }
    page = autotune_page(
        closing,
        loop.shown,
        settings.search.trial.driven.segments,
        settings.sequence.title or settings.sequence.name,
        settings.allowed.in_words(),
        origin_of(used),
    )
    files |= documents(page)
    summary = closing_summary(closing, sorted([*files, SUMMARY]))
    files[SUMMARY] = json_file(summary)
    place.write(files, settings.runs.inputs)
    return summary
