"""The report again, from a recording alone."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hil.app.feedback import LOGGED, Feedback, warn_of_damage
from hil.app.requests import ReportRequest
from hil.app.result_file import RESULT, reading_of, write_result
from hil.app.results_folder import refuse_missing, results_in
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.recording import column_map, read_recording
from hil.core.result import RunResult
from hil.engine import RECORDING
from reports import HTML, JUNIT, PDF, recording_named_in, write_reports
from test_plans import rejudged


@dataclass(frozen=True)
class Renewed:
    """What was written: names of files in `folder` by kind, and the result of a run that has a plan.

    `read`: what was understood of a recording that another tool made.
    """

    result: RunResult | None
    files: dict[str, str]
    recording: Path
    folder: Path
    read: dict[str, Any]


def renew_report(request: ReportRequest, feedback: Feedback = LOGGED) -> Renewed:
    """Judge a recording and write its reports.

    Raises:
        BadInputError: the recording cannot be read, or the folder holds other results.
    """
    path = request.source / RECORDING if request.source.is_dir() else request.source
    refuse_missing(path)
    folder = request.out or path.parent
    renewed = folder.resolve() == path.parent.resolve() and _belongs(folder, path.name)
    names = (JUNIT, HTML, PDF, RESULT)
    with results_in(folder, names, inputs=[path], overwrite=request.overwrite or renewed) as place:
        with feedback.progress(path.name) as show:
            show("reading")
            columns = column_map(request.columns)
            recording = read_recording(path, allow_missing=True, any_replay=True, columns=columns)
            warn_of_damage(feedback, [recording])
            show("judging")
            result = rejudged(recording)
            show("writing the reports")
            written = write_reports(recording, result, folder)
        files = {kind: file.name for kind, file in written.items()}
        if result is not None:
            result = write_result(result, recording, {"recording": path.name, **files}, folder)
        place.remove_stale([*files.values(), *([RESULT] if result else [])])
    return Renewed(result, files, path, folder, reading_of([recording]))


def _belongs(folder: Path, recording: str) -> bool:
    """Whether the reports in a folder, if any, are of the recording with this name beside them."""
    if (folder / HTML).is_file() and recording_named_in(folder / HTML) != recording:
        return False
    try:
        stored = json.loads(read_text(folder / RESULT))
        return bool(stored["files"]["recording"] == recording)
    except BadInputError:
        return not (folder / RESULT).exists()
    except (ValueError, KeyError, TypeError):
        return False
