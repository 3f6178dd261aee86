"""`hil replay`: CAN logs of other tools, decoded to a recording."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from hil.cli._output import console, count_in_words, print_criteria, print_json, progress
from hil.cli._result_file import RESULT, write_result
from hil.cli._results_folder import refuse_missing, results_in
from hil.cli._streams import complain
from hil.cli.commands.replay import Replay
from hil.core.errors import BadInputError
from hil.core.printable import printable, refuse_long
from hil.core.recording import read_recording
from hil.core.result import RunResult
from hil.engine import RECORDING, load_bench
from hil.engine.replay import Replayed, ReplayRequest, replay
from reports import HTML, JUNIT, PDF, write_reports
from test_plans import load_plan


def carry_out(options: Replay) -> int:
    """Carry the command out; its exit code."""
    request = _request(
        options.logs,
        options.bench,
        options.dbc,
        options.bus,
        options.plan,
        options.segments,
        options.operator,
    )
    named = [*request.dbcs.values(), *([options.segments] if options.segments else [])]
    inputs = [*options.logs, *named, *([request.bench.source] if request.bench else [])]
    inputs += [request.plan.source] if request.plan else []
    for path in (*options.logs, *named):
        refuse_missing(path)
    names = (RECORDING, RESULT, JUNIT, HTML, PDF)
    with results_in(
        options.out, names, inputs=inputs, overwrite=options.overwrite, default="replay"
    ) as place:
        path = place.folder / RECORDING
        with progress(", ".join(log.name for log in options.logs)) as show:
            replayed = replay(request, path, show)
            show("writing the reports")
            recording = read_recording(path, least_samples=0, allow_missing=True, any_replay=True)
            written = write_reports(recording, replayed.result, place.folder)
        files = {"recording": RECORDING, **{kind: file.name for kind, file in written.items()}}
        result = replayed.result
        if result is not None:
            result = write_result(result, recording, files, place.folder)
        place.remove_stale([*files.values(), *([RESULT] if result else [])])
    return _told(replayed, result, files, place.folder, as_json=options.as_json)


def _request(
    logs: list[Path],
    bench: str | None,
    dbc: list[str] | None,
    bus: list[str] | None,
    plan: str | None,
    segments: Path | None,
    operator: str,
) -> ReplayRequest:
    refuse_long(operator, "--operator")
    if (bench is None) == (not dbc):
        raise BadInputError(
            "decoding needs either --bench or --dbc",
            fix="with a bench file: the axle's channels; with a DBC: its signals under their own names",
        )
    if bus and bench is None:
        raise BadInputError("--bus goes with --bench", fix="with --dbc write --dbc CHANNEL=FILE")
    dbcs = _pairs(dbc or [], "--dbc", needs_key=False)
    return ReplayRequest(
        logs=logs,
        bench=load_bench(bench) if bench is not None else None,
        dbcs={channel: Path(file) for channel, file in dbcs.items()},
        buses=_pairs(bus or [], "--bus", needs_key=True),
        plan=load_plan(plan) if plan is not None else None,
        segments=segments,
        operator=operator,
    )


def _pairs(given: list[str], option: str, *, needs_key: bool) -> Mapping[str, str]:
    """KEY=VALUE options by key; without one the key is ''."""
    found: dict[str, str] = {}
    for text in given:
        key, equals, value = text.partition("=")
        if not equals:
            key, value = "", text
        if not value or (needs_key and not key):
            raise BadInputError(f"{option} {printable(text)}", fix=f"write {option} NAME=VALUE")
        if key in found:
            whose = f"for {printable(key)}" if key else "for all channels"
            raise BadInputError(f"{option} is given twice {whose}", fix="give it once")
        found[key] = value
    return found


def _told(
    replayed: Replayed, result: RunResult | None, files: Mapping[str, str], folder: Path, *, as_json: bool
) -> int:
    if as_json:
        told = {"frames": replayed.frames, "samples": replayed.samples, "channels": list(replayed.channels)}
        print_json(
            {
                "verdict": None,
                **(result.model_dump(mode="json") if result else {"files": dict(files)}),
                **told,
                "remarks": list(replayed.remarks),
            }
        )
    else:
        page = console()
        for remark in replayed.remarks:
            page.print(f"note: {remark}", highlight=False, markup=False, soft_wrap=True)
        count = f"{replayed.frames} frames: {replayed.samples} samples of {len(replayed.channels)} channels"
        page.print(count, highlight=False)
        if result is not None:
            print_criteria(page, result.criteria)
            page.print(f"\n{result.verdict.upper()}, {count_in_words(result.criteria)}", highlight=False)
            if result.reason:
                complain("error", result.reason)
        page.print(f"report: {folder / files['html']}", highlight=False)
    return 0 if result is None or result.verdict in ("pass", "done") else 1
