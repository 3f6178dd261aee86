"""`hil run`: a plan on a bench, with its recording and reports."""

from __future__ import annotations

import datetime
import sys
from pathlib import Path
from typing import Annotated

import typer

from hil.cli._output import console, print_criteria, print_json, progress
from hil.core.errors import HilError, InterruptError
from hil.core.files import write_atomically
from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.core.result import RunResult
from hil.engine import DEFAULT_BENCH, RunOutcome, RunRequest, load_bench, run_plan
from reports import write_reports
from test_plans import load_plan


def command(
    plan: Annotated[
        str, typer.Argument(help="plan file, or the name of a shipped plan: acceptance, identification")
    ],
    bench: Annotated[str, typer.Option(help="bench file, or the name of a shipped bench")] = DEFAULT_BENCH,
    out: Annotated[Path | None, typer.Option(help="directory for recording and reports")] = None,
    model: Annotated[Path | None, typer.Option(help="model file for the simulated bench")] = None,
    operator: Annotated[str, typer.Option(help="who runs the bench; stands in the report")] = "",
    as_json: Annotated[
        bool, typer.Option("--json", help="print result.json on stdout, nothing else")
    ] = False,
) -> int:
    """Run a test plan on a bench and write recording.mcap, result.json, report.html, report.pdf, junit.xml.

    Exit code: 0 passed, 1 a criterion failed, 2 bad input, 3 the bench failed, 130 interrupted.
    """
    checked = load_plan(plan)
    request = RunRequest(
        plan=checked,
        bench=load_bench(bench),
        out=out or Path("out") / f"{checked.name}-{datetime.datetime.now().astimezone():%Y%m%d-%H%M%S}",
        model=load_model(model) if model else None,
        operator=operator,
        ask=_ask,
    )
    with progress(f"{checked.name} on {request.bench.name}") as show:
        request.progress = show
        outcome = run_plan(request)
    result = _write(outcome, request.out)
    if as_json:
        print_json(result.model_dump(mode="json"))
    else:
        _print(result, request.out)
    if outcome.error is not None:
        print(f"error: {outcome.error}", file=sys.stderr)
        return InterruptError.exit_code if result.safe_state == "not_needed" else _code(outcome.error, result)
    return 0 if result.verdict == "pass" else 1


def _code(error: HilError, result: RunResult) -> int:
    return 3 if result.safe_state == "not_confirmed" else error.exit_code


def _write(outcome: RunOutcome, out: Path) -> RunResult:
    """Reports and result.json; what could not be written is missing from `files`, and said."""
    files = {"recording": outcome.recording.name}
    try:
        written = write_reports(read_recording(outcome.recording, allow_missing=True), outcome.result, out)
        files |= {kind: path.name for kind, path in written.items()}
    except HilError as error:
        outcome.error = outcome.error or error
    result = outcome.result.model_copy(update={"files": files})
    try:
        write_atomically(out / "result.json", result.model_dump_json(indent=2))
    except HilError as error:
        outcome.error = outcome.error or error
    return result


def _print(result: RunResult, out: Path) -> None:
    page = console()
    if result.criteria:
        print_criteria(page, result.criteria)
    page.print(
        f"\n{result.plan} on {result.bench}: [bold]{result.verdict.upper()}[/]"
        f"   safe state {result.safe_state}   {result.bench_time_s:.0f} s of bench time, "
        f"{result.real_time_factor:.0f} x real time",
        highlight=False,
    )
    report = out / result.files["html"] if "html" in result.files else out
    page.print(f"report: {report}", highlight=False)


def _ask(text: str) -> None:
    if not sys.stdin.isatty():
        return  # no operator to ask: a CI job goes on
    print(f"\n{text}\nPress Enter to go on.", file=sys.stderr)
    sys.stdin.readline()
