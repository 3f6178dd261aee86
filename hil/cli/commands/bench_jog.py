"""`hil bench jog`: what every sensor reads when the axle was turned."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.table import Table

from hil.app.result_file import to_json
from hil.app.results_folder import results_in
from hil.cli.options.benches import BenchJog
from hil.cli.output import console, plain_table, print_json, progress
from hil.cli.streams import complain, operators_terminal
from hil.core.errors import BenchError
from hil.core.errors.wording import printable
from hil.core.files import write_atomically
from hil.engine import RECORDING, StopRequest, load_bench
from hil.engine.commissioning.jog import JogOutcome, JogRequest, Sign, jog

JOG = "jog.json"
NAMES = (RECORDING, JOG)
_WORDS = {"right": "right", "wrong": "WRONG", "not_seen": "no motion", "not_there": "no such channel"}
_STYLES = {"right": "green", "wrong": "bold red", "not_seen": "bold red", "not_there": "bold red"}


def execute(options: BenchJog) -> int:
    """Execute the command; its exit code."""
    file, stop = load_bench(options.bench), StopRequest()
    request = JogRequest(
        file, Path(), options.torque, operator=options.operator, confirmed_by=options.yes, stop=stop
    )
    request.terminal = operators_terminal()
    with (
        results_in(
            options.out, NAMES, inputs=[file.source], overwrite=options.overwrite, default="jog", summary=JOG
        ) as place,
        stop.by_signals(),
    ):
        request.out, request.replaces = place.folder, place.stale
        with progress(f"jog on {file.name}") as show:
            request.progress = lambda share, text: show(text, share)
            outcome = jog(request)
        found = _as_dict(outcome)
        write_atomically(place.folder / JOG, to_json(found) + "\n")
        if options.as_json:
            print_json(found)
        else:
            _tell(outcome, place.folder)
    return _exit_code(outcome)


def _as_dict(outcome: JogOutcome) -> dict[str, Any]:
    result, signs = outcome.run.result, outcome.signs
    stopped = outcome.run.error is not None
    return {
        "verdict": "error" if stopped else "right" if signs.right else "wrong",
        "bench": result.bench,
        "safe_state": result.safe_state,
        "signs": [asdict(sign) for sign in signs.signs],
        "findings": [asdict(finding) for finding in signs.findings],
        "identities": [identity.model_dump() for identity in result.identities],
        "zeros": [zero.model_dump() for zero in result.zeros],
        "files": {"recording": RECORDING},
        "reason": result.reason,
    }


def _exit_code(outcome: JogOutcome) -> int:
    error = outcome.run.error
    if error is not None:
        complain("error", str(error))
    if outcome.run.result.safe_state == "not_confirmed":
        return BenchError.exit_code
    if error is not None:
        return error.exit_code
    return 0 if outcome.signs.right else 1


def _tell(outcome: JogOutcome, folder: Path) -> None:
    page = console()
    if outcome.signs.signs:
        page.print(_table(outcome.signs.signs))
        page.print()
    for number, finding in enumerate(outcome.signs.findings, 1):
        page.print(
            f"{number}. {printable(finding.what, 500)}", style="bold red", highlight=False, soft_wrap=True
        )
        for line in (finding.where, finding.fix):
            page.print(f"   {printable(line, 500)}", highlight=False, markup=False, soft_wrap=True)
    verdict = "every sign is right" if outcome.signs.right else "[bold red]not every sign is right[/]"
    state = outcome.run.result.safe_state.replace("_", " ")
    page.print(f"{verdict}   safe state {state}   recording: {folder / RECORDING}", highlight=False)


def _table(signs: tuple[Sign, ...]) -> Table:
    table = plain_table()
    for name in ("asked for", "channel", "changed by", "unit", "sign"):
        table.add_column(name, justify="right" if name == "changed by" else "left", no_wrap=True)
    for sign in signs:
        change = "-" if sign.change is None else f"{sign.change:+.3g}"
        words = f"[{_STYLES[sign.verdict]}]{_WORDS[sign.verdict]}[/]"
        table.add_row(sign.test, sign.channel, change, sign.unit, words)
    return table
