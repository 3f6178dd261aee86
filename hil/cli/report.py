"""`hil report`: the report again, from a recording alone."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._output import console, print_criteria, print_json
from hil.core.errors import BadInputError
from hil.core.files import write_atomically
from hil.core.recording import SEGMENT, Recording, read_recording
from hil.core.result import RunResult, Segment, verdict_of
from hil.engine import RECORDING
from reports import write_reports
from test_plans import judge, plan_from_text


def command(
    source: Annotated[
        Path, typer.Argument(metavar="DIR_OR_RECORDING", help="a run's directory, or a recording")
    ],
    out: Annotated[Path | None, typer.Option(help="where to write; default: beside the recording")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print the result on stdout, nothing else")] = False,
) -> int:
    """Make the report again from a recording; the criteria are computed anew from its channels.

    A recording that another tool made gets a report of its channels, without verdict.
    """
    path = source / RECORDING if source.is_dir() else source
    recording = read_recording(path, allow_missing=True)
    target = out or path.parent
    result = rejudged(recording)
    written = write_reports(recording, result, target)
    files = {kind: file.name for kind, file in written.items()}
    if result is None:
        if as_json:
            print_json({"verdict": None, "files": files})
        else:
            console().print(f"no plan in {path}: a report of its channels\nreport: {written['html']}")
        return 0
    result = result.model_copy(update={"files": {"recording": path.name, **files}})
    write_atomically(target / "result.json", result.model_dump_json(indent=2))
    if as_json:
        print_json(result.model_dump(mode="json"))
    else:
        print_criteria(console(), result.criteria)
        console().print(f"\n{result.verdict.upper()}\nreport: {written['html']}", highlight=False)
    return {"pass": 0, "fail": 1, "error": 1}[result.verdict]


def rejudged(recording: Recording) -> RunResult | None:
    """The run's result with its criteria computed again; None for a recording without a run."""
    if "plan.yaml" not in recording.attachments:
        return None
    where = str(recording.source)
    try:
        stored = _stored(recording)
        text = recording.attachments["plan.yaml"].decode()
    except ValueError as error:
        raise BadInputError(
            "its run.json or plan.yaml is broken", where=where, fix="use another copy"
        ) from error
    plan = plan_from_text(text, f"{where}: plan.yaml", recording.source.parent, files_required=False)
    criteria = judge(plan, recording, stored.segments)
    return stored.model_copy(
        update={"criteria": criteria, "verdict": verdict_of(criteria, stopped=bool(stored.reason))}
    )


def _stored(recording: Recording) -> RunResult:
    """The result as it was stored; of a recording that was cut off, what can still be said."""
    if "run.json" in recording.attachments:
        return RunResult.model_validate_json(recording.attachments["run.json"])
    run = recording.metadata.get("run", {})
    segments = [
        Segment.model_validate_json(table["json"])
        for name, table in recording.metadata.items()
        if name.startswith(SEGMENT)
    ]
    return RunResult(
        verdict="error",
        plan=run.get("plan", "?"),
        bench=run.get("bench", "?"),
        real_time_factor=0.0,
        bench_time_s=float(recording.time_s[-1]),
        safe_state="not_confirmed",
        segments=tuple(segments),
        reason="the recording was cut off before the run had ended; nothing is known of its safe state",
    )
