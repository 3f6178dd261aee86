"""`hil compare`: several runs side by side, of one plan or of its changed copies."""

from __future__ import annotations

from pathlib import Path

from hil.analysis.comparison import Comparison
from hil.app.compare import HTML, compare_runs
from hil.app.requests import CompareRequest
from hil.cli.inputs import request_of
from hil.cli.options.runs import Compare
from hil.cli.output import TERMINAL, console, plain_table, print_json
from reports.comparison import lead, plans_apart, value_text


def execute(options: Compare) -> int:
    """Execute the command; its exit code."""
    outcome = compare_runs(request_of(CompareRequest, options), TERMINAL)
    if options.as_json:
        print_json(outcome.summary)
    else:
        _print(outcome.found, outcome.folder / HTML)
    return 0


def _print(found: Comparison, page: Path) -> None:
    table = plain_table()
    table.add_column("criterion", no_wrap=True)
    for run in found.runs:
        table.add_column(run.name, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for row in found.criteria:
        cells = (value_text(row, index) for index in range(len(found.runs)))
        table.add_row(row.id, *cells, row.unit)
    out = console()
    out.print(table)
    for run in found.runs:
        if run.result.variables:
            values = ", ".join(map(str, run.result.variables))
            where = run.recording.source.parent
            out.print(f"{where}: {values}", highlight=False, markup=False, soft_wrap=True)
    out.print(f"\n{lead(found)}", highlight=False, markup=False)
    for line in plans_apart(found):
        out.print(line, highlight=False, markup=False, soft_wrap=True)
    for note in found.notes:
        out.print(f"note: {note}", highlight=False, markup=False)
    out.print(f"report: {page}", highlight=False, markup=False, soft_wrap=True)
