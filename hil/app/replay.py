"""CAN logs of other tools, decoded to a recording and judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hil.app.feedback import LOGGED, Feedback
from hil.app.result_file import RESULT, write_result
from hil.app.results_folder import refuse_missing, results_in
from hil.core.recording import read_recording
from hil.core.result import RunResult
from hil.engine import RECORDING
from hil.engine.replay import Replayed, ReplayRequest, replay
from reports import HTML, JUNIT, PDF, write_reports


@dataclass(frozen=True)
class ReplayOutcome:
    """What was decoded, the result of a replay with a plan, and names of files in `folder` by kind."""

    replayed: Replayed
    result: RunResult | None
    files: Mapping[str, str]
    folder: Path


def replay_logs(
    request: ReplayRequest, out: Path | None, feedback: Feedback = LOGGED, *, overwrite: bool = False
) -> ReplayOutcome:
    """Decode, judge, and write recording and reports.

    Raises:
        BadInputError: a log or a description cannot be used.
    """
    named = [*request.dbcs.values(), *([request.segments] if request.segments else [])]
    inputs = [*request.logs, *named, *([request.bench.source] if request.bench else [])]
    inputs += [request.plan.source] if request.plan else []
    for path in (*request.logs, *named):
        refuse_missing(path)
    names = (RECORDING, RESULT, JUNIT, HTML, PDF)
    with results_in(out, names, inputs=inputs, overwrite=overwrite, default="replay") as place:
        path = place.folder / RECORDING
        with feedback.progress(", ".join(log.name for log in request.logs)) as show:
            replayed = replay(request, path, show)
            show("writing the reports")
            recording = read_recording(path, least_samples=0, allow_missing=True, any_replay=True)
            written = write_reports(recording, replayed.result, place.folder)
        files = {"recording": RECORDING, **{kind: file.name for kind, file in written.items()}}
        result = replayed.result
        if result is not None:
            result = write_result(result, recording, files, place.folder)
        place.remove_stale([*files.values(), *([RESULT] if result else [])])
    return ReplayOutcome(replayed, result, files, place.folder)
