"""What `hil run` shows at its end: the series, how time was kept, the report in a browser."""

from __future__ import annotations

import logging
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hil.app.run import FinishedRun
from hil.app.series import SUMMARY
from hil.cli.output import console, count_in_words, plain_table
from hil.core.result import Lateness, Timing
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
            facts = (name, limit_in_words(spread), spread["verdict"].replace("_", " "), str(spread["count"]))
            first = (values if number == 0 else "",) if varied else ()
            table.add_row(*first, *facts, *cells, spread["unit"])
    page = console()
    page.print()
    page.print(table)
    page.print(f"\nsummary: {folder / SUMMARY}\nreport: {folder / SERIES_HTML}", highlight=False)


def times_in_words(factor: float) -> str:
    """A real-time factor: 34, 5.2, 0.2; never 0 for what is only slow."""
    return f"{factor:.0f}" if factor >= 10 else f"{factor:.2g}"


def timing_in_words(timing: Timing | None) -> Iterator[str]:
    """A line for each periodic request of a bench in wall-clock time; nothing in virtual time."""
    if timing is None or timing.clock == "virtual":
        return
    for request in timing.requests:
        seen = _late(request.seen) if request.seen else f"not known ({request.why_not_seen})"
        yield (
            f"{request.device} {request.request}: {request.count} every {request.period_s * 1e3:g} ms, sent "
            f"{_late(request.sent)}; on the bus {seen}; {request.missed_in_words}"
        )
    if timing.pauses:
        times = "once" if timing.pauses == 1 else f"{timing.pauses} times"
        yield f"the bench loop was delayed {times}, at most {timing.longest_pause_s:g} s"


def _late(late: Lateness) -> str:
    return f"p50 {late.p50_ms:.2g} p99 {late.p99_ms:.2g} largest {late.max_ms:.2g} ms late"


logger = logging.getLogger(__name__)


def show_in_browser(page: Path) -> None:
    """Ask for a browser and do not wait for it; nothing is stated where there is none.

    In a process of its own: some browsers write to the terminal, and some last as long as their window.
    """
    nothing = subprocess.DEVNULL
    try:
        subprocess.Popen(
            [sys.executable, "-m", "webbrowser", page.resolve().as_uri()],
            stdin=nothing,
            stdout=nothing,
            stderr=nothing,
            start_new_session=True,
        )
    except OSError as error:
        logger.info("no browser: %s", error)
