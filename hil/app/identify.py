"""From recordings to frequency responses, transfer functions and a driveline chain."""

from __future__ import annotations

from typing import get_args

from hil.analysis.frequency_response import Experiment, Method, experiments_of
from hil.analysis.identification import Identification, identify
from hil.analysis.plausible import refuse_same_data
from hil.app.feedback import LOGGED, Feedback, Show, warn_of_damage
from hil.app.requests import IdentifyRequest
from hil.app.result_file import Outcome, json_file, reading_of
from hil.app.results_folder import refuse_missing, results_in
from hil.core.errors import BadInputError
from hil.core.recording import Recording, column_map, read_recording
from reports import HTML, PDF
from reports.identification_report import identification_page
from reports.origin import origin_of
from reports.outputs.identification import output_files, summary_of
from reports.parts import documents

SUMMARY = "identification.json"
_NAMES = (SUMMARY, "model.toml", "physical.toml", "frf.csv", HTML, PDF)
_LEAST_SAMPLES = 100
_HIGHEST_HZ = 30.0


def identify_recordings(request: IdentifyRequest, feedback: Feedback = LOGGED) -> Outcome[Identification]:
    """Identify, and write model, responses and report.

    Raises:
        BadInputError: a recording or a choice cannot be used.
    """
    from_hz, to_hz = request.from_hz, request.to_hz
    method = _method(request.method)
    if from_hz is not None and to_hz is not None and from_hz >= to_hz:
        raise BadInputError(
            f"--from-hz {from_hz:g} is not below --to-hz {to_hz:g}", fix="give the lower frequency first"
        )
    for path in request.recordings:
        refuse_missing(path)
    with results_in(
        request.out,
        _NAMES,
        inputs=request.recordings,
        overwrite=request.overwrite,
        default="identify",
        summary=SUMMARY,
    ) as place:
        with feedback.progress("identification") as show:
            recordings = _recordings(request, feedback, show)
            experiments = _experiments(recordings, request)
            found = identify(
                experiments,
                from_hz=from_hz,
                to_hz=to_hz,
                method=method,
                order=request.order,
                gear_ratio=request.gear_ratio,
                progress=show,
            )
            show("figures")
            files = output_files(found)
            summary = summary_of(found, experiments, sorted([*files, HTML, PDF]))
            summary["read"] = reading_of(recordings)
            title = ", ".join(path.name for path in request.recordings)
            origin = origin_of({"recording": request.recordings}, summary["read"])
            page = identification_page(found, summary, title, origin)
            files |= documents(page)
            files[SUMMARY] = json_file(summary)
        place.write(files, request.recordings)
    for doubt in found.doubts:
        feedback.warn(doubt)
    return Outcome(found, summary, place.folder)


def _method(name: str) -> Method:
    methods: tuple[Method, ...] = get_args(Method)
    for known in methods:
        if name == known:
            return known
    raise BadInputError(f"--method is '{name}'", fix=f"one of: {', '.join(methods)}")


def _recordings(request: IdentifyRequest, feedback: Feedback, show: Show) -> list[Recording]:
    recordings = []
    columns = column_map(request.columns)
    for path in request.recordings:
        show(f"reading {path.name}")
        recordings.append(read_recording(path, least_samples=_LEAST_SAMPLES, columns=columns))
    warn_of_damage(feedback, recordings)
    refuse_same_data(recordings)
    return recordings


def _experiments(recordings: list[Recording], request: IdentifyRequest) -> list[Experiment]:
    return [
        experiment
        for recording in recordings
        for experiment in experiments_of(
            recording,
            segments=request.segments or (),
            input_channel=request.input_channel,
            to_hz=request.to_hz or _HIGHEST_HZ,
            hold_s=None if request.hold_ms is None else request.hold_ms / 1000,
        )
    ]
