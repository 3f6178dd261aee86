"""`hil report`: the report again, from a recording alone."""

from __future__ import annotations

import json
from pathlib import Path

from hil.cli._output import (
    console,
    count_in_words,
    print_criteria,
    print_json,
    progress,
    warn_of_damage,
)
from hil.cli._result_file import RESULT, write_result
from hil.cli._results_folder import refuse_missing, results_in
from hil.cli._streams import complain
from hil.cli.commands.report import Report
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.recording import read_recording
from hil.core.result import RunResult
from hil.engine import RECORDING
from reports import HTML, JUNIT, PDF, recording_named_in, write_reports
from test_plans import rejudged


def carry_out(options: Report) -> int:
    """Carry the command out; its exit code."""
    path = options.source / RECORDING if options.source.is_dir() else options.source
    refuse_missing(path)
    folder = options.out or path.parent
    renewed = folder.resolve() == path.parent.resolve() and _belongs(folder, path.name)
    names = (JUNIT, HTML, PDF, RESULT)
    with results_in(folder, names, inputs=[path], overwrite=options.overwrite or renewed) as place:
        with progress(path.name) as show:
            show("reading")
            recording = read_recording(path, allow_missing=True, any_replay=True)
            warn_of_damage([recording])
            show("judging")
            result = rejudged(recording)
            show("writing the reports")
            written = write_reports(recording, result, folder)
        files = {kind: file.name for kind, file in written.items()}
        if result is not None:
            result = write_result(result, recording, {"recording": path.name, **files}, folder)
        place.remove_stale([*files.values(), *([RESULT] if result else [])])
    return _told(result, files, path, folder, as_json=options.as_json)


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


def _told(result: RunResult | None, files: dict[str, str], path: Path, folder: Path, *, as_json: bool) -> int:
    page = folder / files["html"]
    if result is None:
        if as_json:
            print_json({"verdict": None, "files": files})
        else:
            console().print(f"no plan in {path}: a report of its channels\nreport: {page}", highlight=False)
        return 0
    if as_json:
        print_json(result.model_dump(mode="json"))
    else:
        print_criteria(console(), result.criteria)
        verdict = f"{result.verdict.upper()}, {count_in_words(result.criteria)}"
        console().print(f"\n{verdict}\nreport: {page}", highlight=False)
        if result.reason:
            complain("error" if result.verdict == "error" else "note", result.reason)
    return {"pass": 0, "done": 0, "fail": 1, "error": 1}[result.verdict]
