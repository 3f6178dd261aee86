"""Why recordings and a model differ, the missing effect, and the better model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from hil.analysis.diagnosis import INTERRUPTED, LEAST_SAMPLES, Diagnosis, diagnose
from hil.app.feedback import LOGGED, Feedback, Show, warn_of_damage
from hil.app.interrupts import INTERRUPTS
from hil.app.requests import DiagnoseRequest
from hil.app.result_file import Outcome, json_file, reading_of
from hil.app.results_folder import results_in
from hil.core.errors import BadInputError
from hil.core.model import Model, load_model, model_to_toml
from hil.core.recording import AS_NAMED, ColumnMap, Recording, column_map, driven_by_torque, read_recording
from reports.diagnosis import diagnosis_documents
from reports.origin import Origin, origin_of

SUMMARY = "diagnosis.json"
FILES = ("model.toml", SUMMARY, "report.html", "report.pdf")


def diagnose_recordings(request: DiagnoseRequest, feedback: Feedback = LOGGED) -> Outcome[Diagnosis]:
    """Diagnose, and write the better model, plans of separating tests and the report.

    An interrupt ends the search: `unfinished` of the outcome says so, and the result so far is written.

    Raises:
        BadInputError: the recordings cannot belong to the model, or a choice cannot be used.
    """
    base = load_model(request.model)
    holdout = list(request.holdout or ())
    _refuse_twice(request.recordings, holdout)
    inputs = [request.model, *request.recordings, *holdout]
    columns = column_map(request.columns)
    with results_in(
        request.out, FILES, inputs=inputs, overwrite=request.overwrite, default="diagnose", summary=SUMMARY
    ) as place:
        with feedback.progress("diagnosis") as show:
            fitted = stretches_of(request.recordings, base, feedback, show, columns)
            held = stretches_of(holdout, base, feedback, show, columns)
            reading = reading_of([*fitted, *held])
            found = diagnose(
                base,
                fitted,
                held,
                noise=dict(request.noise),
                least=dict(request.least),
                at_most_s=60.0 * request.at_most,
                show=show,
            )
            if found.unfinished == INTERRUPTED:
                INTERRUPTS.answered()
            show("writing the report")
            origin = origin_of(
                {"model": [request.model], "recording": request.recordings, "held out": holdout}, reading
            )
            files = output_files(found, request.model.name, origin, reading)
        place.write(files, inputs)
    return Outcome(found, _summary(found, files, reading), place.folder)


def _summary(found: Diagnosis, files: Iterable[str], reading: Mapping[str, Any]) -> dict[str, Any]:
    return {**found.as_json(), "read": dict(reading), "files": sorted({*files, SUMMARY})}


def _refuse_twice(recordings: list[Path], holdout: list[Path]) -> None:
    """A recording counts once, and one that a fit has seen is not held out.

    Raises:
        BadInputError: names the file.
    """
    seen: dict[Path, str] = {}
    for role, paths in (("a recording", recordings), ("--holdout", holdout)):
        for path in paths:
            other = seen.setdefault(path.resolve(), role)
            if other != role:
                raise BadInputError(
                    "is given both as a recording and as --holdout",
                    where=str(path),
                    fix="a recording used in the fit cannot validate it: give another one to --holdout",
                )
        if len({path.resolve() for path in paths}) < len(paths):
            twice = next(p for p in paths if sum(p.resolve() == q.resolve() for q in paths) > 1)
            raise BadInputError(f"is given twice as {role}", where=str(twice), fix="give it once")


def stretches_of(
    paths: list[Path], base: Model, feedback: Feedback, show: Show, columns: ColumnMap = AS_NAMED
) -> list[Recording]:
    """The stretches of all files that a model can explain: driven by torque alone, or by its load too."""
    parts = []
    for path in paths:
        show(f"reading {path.name}")
        whole = read_recording(path, least_samples=LEAST_SAMPLES, columns=columns)
        warn_of_damage(feedback, [whole])
        parts += [whole] if base.load_input else driven_by_torque(whole)
    return parts


def output_files(
    found: Diagnosis, title: str, origin: Origin | None = None, reading: Mapping[str, Any] | None = None
) -> dict[str, bytes]:
    """Names and contents of all that the command writes."""
    files = {
        "model.toml": model_to_toml(found.model).encode(),
        **diagnosis_documents(found, title, origin),
    }
    for a in found.alternatives:
        if a.plan and a.plan_text:
            files[a.plan] = a.plan_text.encode()
    files[SUMMARY] = json_file(_summary(found, files, reading or {}))
    return files
