"""`hil explain`: what would bring a predicted run to target figures."""

from __future__ import annotations

from pathlib import Path

from hil.analysis.target_search import Explanation
from hil.app.explain import HTML, explain_targets
from hil.app.interrupts import EXIT_CODE, INTERRUPTS
from hil.app.requests import ExplainRequest
from hil.cli.inputs import named_numbers, request_of
from hil.cli.options.models import Explain
from hil.cli.output import TERMINAL, console, plain_table, print_json
from hil.cli.run_inputs import bench_or_own
from reports.target_search import caution


def execute(options: Explain) -> int:
    """Execute the command; its exit code."""
    request = request_of(
        ExplainRequest,
        options,
        figures=named_numbers(options.target or [], "--target"),
        bench=bench_or_own(options.bench, options.plan),
    )
    outcome = explain_targets(request, TERMINAL)
    found = outcome.found
    if options.as_json:
        print_json(outcome.summary)
    else:
        _print(found, outcome.folder)
    if found.interrupted:
        INTERRUPTS.tell()
        return EXIT_CODE
    return 0 if found.reached else 1


def _print(found: Explanation, folder: Path) -> None:
    out = console()
    table = plain_table()
    table.add_column("rival")
    for name in found.targets.values:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("missed", justify="right", no_wrap=True)
    table.add_row("target", *(f"{value:.4g}" for value in found.targets.values.values()), "")
    for name, rival in (("base model", found.base), *((r.name, r) for r in found.rivals)):
        figures = (rival.outcome.figures[n] for n in found.targets.values)
        cells = ("-" if figure is None else f"{figure:.4g}" for figure in figures)
        table.add_row(name, *cells, f"{len(rival.missed)} of {len(rival.conditions)}")
    out.print(table)
    for text in ("", found.verdict, caution(found)):
        out.print(text, highlight=False, markup=False)
    out.print(f"report: {folder / HTML}", highlight=False, markup=False, soft_wrap=True)
