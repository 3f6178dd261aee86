"""What `hil run` prints of several runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hil.app.run import FinishedRun
from hil.app.series import SUMMARY
from hil.cli._output import console, count_in_words, plain_table
from reports.series_report import SERIES_HTML, limit_in_words, values_in_words


def print_in_series(run: FinishedRun) -> None:
    """Print a line for a run that has ended."""
    values = ", ".join(map(str, run.result.variables))
    console().print(
        f"{run.folder.name}  {values}: [bold]{run.result.verdict.upper()}[/], "
        f"{count_in_words(run.result.criteria)}",
        highlight=False,
    )


def print_series(summary: dict[str, Any], folder: Path) -> None:
    """Print how the criteria of a series spread."""
    table = plain_table()
    varied = any(group["variables"] for group in summary["spread"])
    if varied:
        table.add_column("variables")
    table.add_column("criterion", overflow="fold")
    table.add_column("limit", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for name in ("runs", "mean", "std. dev.", "lowest", "highest"):
        table.add_column(name, justify="right", no_wrap=True, min_width=6)
    table.add_column("unit", no_wrap=True)
    for group in summary["spread"]:
        values = values_in_words(group["variables"])
        for number, (name, spread) in enumerate(group["criteria"].items()):
            numbers = (spread[key] for key in ("mean", "standard_deviation", "lowest", "highest"))
            cells = ("-" if value is None else f"{value:.4g}" for value in numbers)
            said = (name, limit_in_words(spread), spread["verdict"].replace("_", " "), str(spread["count"]))
            first = (values if number == 0 else "",) if varied else ()
            table.add_row(*first, *said, *cells, spread["unit"])
    page = console()
    page.print()
    page.print(table)
    page.print(f"\nsummary: {folder / SUMMARY}\nreport: {folder / SERIES_HTML}", highlight=False)
