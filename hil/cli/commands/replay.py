"""`hil replay`: CAN logs of other tools, decoded to a recording."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import cast, get_args

from hil.app.replay import replay_logs
from hil.cli.inputs import named_numbers
from hil.cli.options.runs import Replay
from hil.cli.output import TERMINAL, console, count_in_words, print_criteria, print_json
from hil.cli.streams import complain
from hil.core.can_logs import Stamps
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable, refuse_long
from hil.core.recording import column_map
from hil.engine import load_bench
from hil.engine.replay import ReplayRequest
from test_plans import load_plan


def execute(options: Replay) -> int:
    """Execute the command; its exit code."""
    outcome = replay_logs(_request(options), options.out, TERMINAL, overwrite=options.overwrite)
    replayed, result = outcome.replayed, outcome.result
    if options.as_json:
        print_json(
            {
                "verdict": None,
                **(result.model_dump(mode="json") if result else {"files": dict(outcome.files)}),
                "frames": replayed.counts.all,
                "frame_counts": replayed.counts.as_json(),
                "samples": replayed.samples,
                "channels": list(replayed.channels),
                "remarks": list(replayed.remarks),
                "columns": dict(replayed.columns),
            }
        )
    else:
        page = console()
        for remark in replayed.remarks:
            page.print(f"note: {remark}", highlight=False, markup=False, soft_wrap=True)
        channels = f"{replayed.samples} samples of {len(replayed.channels)} channels"
        count = f"{replayed.counts.all} frames, {replayed.counts.decoded} decoded: {channels}"
        page.print(count, highlight=False)
        if result is not None:
            print_criteria(page, result.criteria)
            page.print(f"\n{result.verdict.upper()}, {count_in_words(result.criteria)}", highlight=False)
            if result.reason:
                complain("error", result.reason)
        page.print(f"report: {outcome.folder / outcome.files['html']}", highlight=False)
    return 0 if result is None or result.verdict in ("pass", "done") else 1


def _request(options: Replay) -> ReplayRequest:
    refuse_long(options.operator, "--operator")
    bench, bus, plan = options.bench, options.bus, options.plan
    if (bench is None) == (not options.dbc):
        raise BadInputError(
            "decoding needs either --bench or --dbc",
            fix="with a bench file: the axle's channels; with a DBC: its signals under their own names",
        )
    if options.columns and bench is not None:
        raise BadInputError(
            "--columns goes with --dbc", fix="with --bench its file states which signals are which channels"
        )
    if bus and bench is None:
        raise BadInputError("--bus goes with --bench", fix="with --dbc write --dbc CHANNEL=FILE")
    dbcs = _pairs(options.dbc or [], "--dbc", needs_key=False)
    return ReplayRequest(
        logs=options.logs,
        bench=load_bench(bench) if bench is not None else None,
        dbcs={channel: Path(file) for channel, file in dbcs.items()},
        buses=_pairs(bus or [], "--bus", needs_key=True),
        plan=load_plan(plan) if plan is not None else None,
        segments=options.segments,
        operator=options.operator,
        stamps=_stamps(options.stamps),
        columns=column_map(options.columns),
        shifts_s=named_numbers(options.shift or [], "--shift"),
    )


def _stamps(given: str) -> Stamps:
    for known in get_args(Stamps):
        if given == known:
            return cast(Stamps, known)
    raise BadInputError(f"--stamps is '{printable(given, 40)}'", fix="one of: append, sort, log, block")


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
