"""What would bring a predicted run to target figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hil.analysis.target_search import (
    SEPARATING,
    CarryOut,
    Explanation,
    Predicted,
    explain,
    files_of,
    model_name,
    read_targets,
)
from hil.app.feedback import LOGGED, Feedback
from hil.app.requests import ExplainRequest
from hil.app.result_file import Outcome, json_file
from hil.app.results_folder import results_in
from hil.core.errors import BadInputError
from hil.core.files.toml_file import FORMAT
from hil.core.model import Model, load_model
from hil.engine import BenchFile, StopRequest, load_bench
from hil.engine.prediction.prediction import predict
from hil.plant import refuse_too_stiff
from reports.target_search import caution, explanation_html, explanation_pdf
from test_plans import Plan

SUMMARY, HTML, PDF = "targets.json", "report.html", "report.pdf"


def explain_targets(request: ExplainRequest, feedback: Feedback = LOGGED) -> Outcome[Explanation]:
    """Search, and write models, separating plan, summary and report.

    Raises:
        BadInputError: plan, bench, model or targets cannot be used.
    """
    wanted = read_targets(request.targets, request.plan, dict(request.figures))
    file = load_bench(request.bench)
    if file.simulation is None:
        raise BadInputError(
            "is not a simulated bench", where=str(file.source), fix="give a bench file with [simulation]"
        )
    source = request.model or file.simulation.model
    base = load_model(source)
    refuse_too_stiff(base)
    inputs = [path for path in (request.targets, source, file.source) if path is not None]
    names = (SUMMARY, HTML, PDF, SEPARATING, model_name(1))
    stop = StopRequest()
    with results_in(
        request.out, names, inputs=inputs, overwrite=request.overwrite, default="explain", summary=SUMMARY
    ) as place:
        with feedback.progress("explain") as show, stop.by_signals():
            found = explain(
                base,
                _predicted_on(file),
                wanted,
                evaluations=request.evaluations,
                among=list(request.among or ()),
                seed=request.seed,
                show=lambda text, share: show(text, share),
                stopped=lambda: stop.times > 0,
            )
        files = files_of(found)
        summary = _summary(found, request.seed, sorted({*files, SUMMARY, HTML, PDF}))
        files |= {
            HTML: explanation_html(found).encode(),
            PDF: explanation_pdf(found),
            SUMMARY: json_file(summary),
        }
        place.write(files, inputs)
    return Outcome(found, summary, place.folder)


def _predicted_on(file: BenchFile) -> CarryOut:
    """Predictions on a bench whose RMCU keeps some parameters more."""
    assert file.simulation is not None
    simulation = file.simulation

    def execute(plan: Plan, model: Model, held: Mapping[str, float]) -> Predicted:
        kept = simulation.model_copy(update={"rmcu": {**simulation.rmcu, **held}})
        return predict(plan, file.model_copy(update={"simulation": kept}), model)

    return execute


def _summary(found: Explanation, seed: int, files: list[str]) -> dict[str, Any]:
    return {
        "plan": found.targets.plan.name,
        "targets": dict(found.targets.values),
        "tolerance": found.targets.tolerance,
        "reached": found.reached,
        "format": FORMAT,
        "verdict": found.verdict,
        "caution": caution(found),
        "rivals": [rival.as_json(model_name(n)) for n, rival in enumerate(found.rivals, 1)],
        "base": found.base.as_json(""),
        "separating": None
        if found.separating is None
        else {"plan": SEPARATING, "words": found.separating.words, "noise_levels": found.separating.level},
        "searched": found.searched,
        "evaluations": found.evaluations,
        "seed": seed,
        "interrupted": found.interrupted,
        "files": files,
    }
