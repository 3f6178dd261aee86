"""Several runs side by side, of one plan or of its changed copies."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

from hil.analysis.comparison import ComparedRun, Comparison, compare, differences, names_by_variables
from hil.app.feedback import LOGGED, Feedback, Show, warn_of_damage
from hil.app.requests import CompareRequest
from hil.app.result_file import Outcome, json_file
from hil.app.results_folder import refuse_missing, results_in
from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from hil.engine import RECORDING
from reports.comparison import comparison_html, comparison_pdf
from test_plans import rejudged

SUMMARY, HTML, PDF = "comparison.json", "report.html", "report.pdf"


def compare_runs(request: CompareRequest, feedback: Feedback = LOGGED) -> Outcome[Comparison]:
    """Compare, and write summary and report.

    Raises:
        BadInputError: a run cannot be read, or they have no channel in common.
    """
    paths = [path / RECORDING if path.is_dir() else path for path in request.runs]
    for path in paths:
        refuse_missing(path)
    _refuse_twice(paths)
    names = (SUMMARY, HTML, PDF)
    with results_in(
        request.out, names, inputs=paths, overwrite=request.overwrite, default="compare", summary=SUMMARY
    ) as place:
        with feedback.progress("comparison") as show:
            found = compare(_read(request.runs, paths, feedback, show))
            show("writing the report")
            summary = _summary(found, request.runs)
            files = {
                HTML: comparison_html(found).encode(),
                PDF: comparison_pdf(found),
                SUMMARY: json_file(summary),
            }
        place.write(files, paths)
    return Outcome(found, summary, place.folder)


def _refuse_twice(paths: list[Path]) -> None:
    for path, times in Counter(path.resolve() for path in paths).items():
        if times > 1:
            raise BadInputError("is given twice", where=str(path), fix="name each run once")


def _read(runs: list[Path], paths: list[Path], feedback: Feedback, show: Show) -> list[ComparedRun]:
    folders = _folders(runs)
    recordings, results = [], []
    for name, path in zip(folders, paths, strict=True):
        show(f"reading {name}")
        recording = read_recording(path, allow_missing=True)
        warn_of_damage(feedback, [recording])
        result = rejudged(recording)
        if result is None:
            raise BadInputError(
                "is not a run of a plan: another tool made it",
                where=str(path),
                fix="compare runs of 'hil run'",
            )
        recordings.append(recording)
        results.append(result)
    names = names_by_variables(folders, results)
    return [ComparedRun(*run) for run in zip(names, recordings, results, strict=True)]


def _folders(runs: list[Path]) -> list[str]:
    """The last parts of the paths, as many as tell them apart."""
    resolved = [path.resolve() for path in runs]
    for parts in range(1, max(len(path.parts) for path in resolved) + 1):
        names = ["/".join(path.parts[-parts:]) for path in resolved]
        if len(set(names)) == len(names):
            return names
    return [str(path) for path in resolved]


def _summary(found: Comparison, runs: list[Path]) -> dict[str, Any]:
    return {
        "plan": found.runs[0].result.plan,
        "runs": [
            {
                "name": run.name,
                "path": str(path),
                "plan": run.result.plan,
                "bench": run.result.bench,
                "variables": {one.name: one.value for one in run.result.variables},
                "started_at": run.recording.metadata.get("run", {}).get("started_at", ""),
                "verdict": run.result.verdict,
                "mean_distance": distance,
            }
            for run, path, distance in zip(found.runs, runs, found.distances, strict=True)
        ],
        "criteria": [
            {
                "id": row.id,
                "unit": row.unit,
                "values": row.values,
                "relative_difference": row.relative,
                "verdicts": row.verdicts,
            }
            for row in found.criteria
        ],
        "responses": [
            {"segment": row.segment, "channel": row.channel, "gaps": row.gaps, "ripples": row.ripples}
            for row in found.responses
        ],
        "differences": [
            {"run": run.name, **vars(one)}
            for run in found.runs[1:]
            for one in differences(found.runs[0], run)
        ],
        "notes": found.notes,
        "files": [SUMMARY, HTML, PDF],
    }
