"""`hil list runs`: runs below a folder as a table, or as JSON."""

from __future__ import annotations

import datetime
from pathlib import Path

from rich.markup import escape

from hil.app.run_list import FoundRun, FoundRuns, RunsWanted, find_runs
from hil.cli.options.files import List
from hil.cli.output import console, local_time, plain_table, print_json, time_zone, warn
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable, share

_DEFAULT = Path("out")
_DASH = "-"
_STYLE = {"pass": "green", "fail": "bold red", "error": "bold magenta"}


def list_runs(options: List) -> int:
    """Execute the command; its exit code."""
    if options.server:
        from hil.cli.remote_runs import list_remote_runs  # costs a list of a folder nothing

        return list_remote_runs(options, moment(options.since, "--since"), moment(options.until, "--until"))
    if options.tag:
        raise BadInputError("only runs of a service have tags", where="--tag", fix="add --server URL")
    folder = options.folder or _DEFAULT
    wanted = RunsWanted(
        plan=tuple(options.plan or ()),
        bench=tuple(options.bench or ()),
        verdict=tuple(options.verdict or ()),
        since=moment(options.since, "--since"),
        until=moment(options.until, "--until"),
        criterion=options.criterion,
        above=options.above,
        below=options.below,
        sort=options.sort,
        rising=options.rising,
        most=options.most,
    )
    found = find_runs(folder, wanted)
    for path in found.unread:
        warn(f"{path}: is no result of a run that can be read; left out")
    if options.as_json:
        print_json({"runs": [run.as_json() for run in found.runs], "total": found.total})
    else:
        _print_table(found, folder, criterion=options.criterion)
    return 0


def moment(text: str, option: str) -> datetime.datetime | None:
    """A date, or a date and a time of day, in this machine's time zone unless it has one."""
    if not text:
        return None
    try:
        return datetime.datetime.fromisoformat(text).astimezone()
    except (ValueError, OverflowError) as error:
        raise BadInputError(
            f"'{printable(text, 60)}' is no date",
            where=option,
            fix="write it by ISO 8601, such as 2026-11-28 or 2026-11-28T06:00",
        ) from error


def _print_table(found: FoundRuns, folder: Path, *, criterion: str) -> None:
    page = console()
    if not found.runs:
        none = f"none of the {found.read} runs below {folder} passes the filter"
        text = none if found.read else f"no runs below {folder}"
        page.print(text, highlight=False, markup=False, soft_wrap=True)
        return
    table = plain_table()
    table.add_column("run", no_wrap=True)
    table.add_column(f"started ({time_zone()})", no_wrap=True)
    for name in ("plan", "bench", "verdict"):
        table.add_column(name)
    table.add_column("worst margin", justify="right", no_wrap=True)
    table.add_column("of")
    if criterion:
        table.add_column(escape(criterion), justify="right", no_wrap=True)
    for run in found.runs:
        table.add_row(*_cells(run, criterion=criterion))
    page.print(table)
    if found.total > len(found.runs):
        page.print(f"{len(found.runs)} of {found.total} runs", style="dim", highlight=False)


def _cells(run: FoundRun, *, criterion: str) -> list[str]:
    started = local_time(run.started)
    style = _STYLE.get(run.verdict)
    verdict = escape(run.verdict)
    cells = [
        escape(str(run.folder)),
        started,
        escape(run.plan),
        escape(run.bench),
        f"[{style}]{verdict}[/]" if style else verdict,
        _DASH if run.margin is None else share(run.margin),
        "" if run.worst is None else escape(run.worst.id),
    ]
    if criterion:
        one = run.wanted
        cells.append(_DASH if one is None or one.value is None else f"{one.value:.5g} {one.unit}".strip())
    return cells
