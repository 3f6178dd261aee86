"""`hil autotune`: a sequence of runs and analyses on a bench, until prediction and run agree."""

from __future__ import annotations

from pathlib import Path

from hil.app.autotune.autotune import autotune
from hil.app.interrupts import EXIT_CODE, INTERRUPTS
from hil.app.requests import AutotuneRequest
from hil.cli.inputs import named_numbers, request_of
from hil.cli.options.controllers import Autotune
from hil.cli.output import TERMINAL, console, plain_table, print_json
from hil.cli.run_inputs import bench_or_own
from hil.core.errors import BadInputError
from hil.core.errors.wording import share
from reports import HTML
from reports.outputs.autotune import Closing, Decision, closing_verdict


def execute(options: Autotune) -> int:
    """Execute the command; its exit code."""
    if options.resume and options.out is None:
        raise BadInputError(
            "--resume goes with --out", where="--resume", fix="name the directory to continue with --out"
        )
    request = request_of(
        AutotuneRequest,
        options,
        bench=bench_or_own(options.bench, drives=True),
        envelope=named_numbers(options.envelope or [], "--envelope"),
    )
    outcome = autotune(request, TERMINAL, _print_nothing if options.json_ else _print_decision)
    if options.json_:
        print_json(outcome.summary)
    else:
        _print(outcome.found.closing, outcome.folder)
    if outcome.found.exit_code == EXIT_CODE:
        INTERRUPTS.tell()
    return outcome.found.exit_code


def _print_nothing(decision: Decision) -> None:
    del decision


def _print_decision(one: Decision) -> None:
    where = f"round {one.round}, {one.stage}" if one.round else one.stage
    text = f"{where}: {one.found}\n  {one.decided}: {one.why}"
    console().print(text, highlight=False, markup=False, soft_wrap=True)


def _print(closing: Closing, folder: Path) -> None:
    page, best = console(), closing.best
    if best is not None:
        table = plain_table("\nmargins, of the limits")
        table.add_column("criterion", no_wrap=True)
        for name in ("before", "predicted", "measured"):
            table.add_column(name, justify="right")
        for name, measured in best.measured.items():
            before = closing.before_margins.get(name)
            own = "-" if before is None else share(before)
            table.add_row(name, own, share(best.predicted.margins[name]), share(measured))
        page.print(table)
    text = f"{closing_verdict(closing)}\nreport: {folder / HTML}"
    page.print(text, highlight=False, markup=False, soft_wrap=True)
