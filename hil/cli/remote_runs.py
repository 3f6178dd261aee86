"""`hil list runs --server URL`: runs of a bench service, chosen and sorted by it."""

from __future__ import annotations

import datetime
import os

from pydantic import ValidationError
from rich.markup import escape

from hil.api_schemas.run_list import LONGEST_PAGE, FoundRun, RunsWanted
from hil.cli.options.files import List
from hil.cli.output import console, local_time, plain_table, print_json, time_zone
from hil.cli.remote_run import TOKEN
from hil.client import Client
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable

_ORDERS = {name: name for name in ("run", "plan", "bench", "verdict", "value")} | {"started": "run"}
_DASH = "-"


def list_remote_runs(options: List, since: datetime.datetime | None, until: datetime.datetime | None) -> int:
    """Execute the command; its exit code.

    Raises:
        BadInputError: the service has no such order or filter, or refuses it.
        BenchError: the service cannot be reached.
    """
    if options.folder is not None:
        raise BadInputError("DIR does not go with --server", where="--server", fix="leave one of them out")
    if options.sort not in _ORDERS:
        fix = did_you_mean(options.sort, list(_ORDERS))
        text = f"a service does not sort by '{printable(options.sort, 60)}'"
        raise BadInputError(text, where="--sort", fix=fix)
    found = Client(options.server, os.environ.get(TOKEN, "")).find_runs(_wanted(options, since, until))
    if options.as_json:
        print_json(found.model_dump(mode="json"))
        return 0
    page, table = console(), plain_table()
    columns = ("run", "plan", "bench", "DUT", "state", "verdict", f"ended ({time_zone()})", "tags")
    for name in columns:
        table.add_column(name)
    if options.criterion:
        table.add_column(escape(options.criterion), justify="right")
    for one in found.runs:
        table.add_row(*_cells(one, criterion=bool(options.criterion)))
    if found.runs:
        page.print(table)
    page.print(f"{len(found.runs)} of {found.total} runs", style="dim", highlight=False)
    return 0


def _wanted(options: List, since: datetime.datetime | None, until: datetime.datetime | None) -> RunsWanted:
    try:
        return RunsWanted.model_validate(
            {
                "plan": options.plan or [],
                "bench": options.bench or [],
                "verdict": options.verdict or [],
                "tag": options.tag or [],
                "since": since,
                "until": until,
                "criterion": options.criterion,
                "above": options.above,
                "below": options.below,
                "sort": _ORDERS[options.sort],
                "rising": options.rising,
                "most": min(options.most or LONGEST_PAGE, LONGEST_PAGE),
            }
        )
    except ValidationError as error:
        first = error.errors()[0]
        name = str(first["loc"][0]) if first["loc"] else "options"
        text = f"'{printable(first['input'], 60)}': {first['msg']}"
        raise BadInputError(text, where=f"--{name}", fix="see hil list --help") from error


def _cells(one: FoundRun, *, criterion: bool) -> list[str]:
    run = one.run
    ended = local_time(run.ended_at)
    cells = [
        str(run.id),
        run.plan,
        run.bench,
        run.dut or _DASH,
        run.state,
        run.verdict or _DASH,
        ended,
        " ".join(one.tags),
    ]
    if criterion:
        cells.append(_DASH if one.value is None else f"{one.value:.5g} {one.unit}".strip())
    return [escape(cell) for cell in cells]
