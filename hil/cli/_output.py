"""What commands print: tables for people, one JSON object for programs, progress for terminals."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Iterator
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from hil.core.result import CriterionResult

_STYLE = {"pass": "green", "fail": "bold red", "error": "bold red"}


def print_json(value: dict[str, Any]) -> None:
    """The one JSON object of `--json`."""
    json.dump(value, sys.stdout, indent=2, ensure_ascii=False)
    sys.stdout.write("\n")


def console() -> Console:
    """Standard output for people; in a pipe wide enough not to break a table."""
    return Console(soft_wrap=False) if sys.stdout.isatty() else Console(width=140)


@contextlib.contextmanager
def progress(description: str) -> Iterator[Callable[[float, str], None]]:
    """A bar on a terminal, nothing in a pipe; call it with (share done, what is going on)."""
    if not sys.stderr.isatty():
        yield lambda share, text: None
        return
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %  {task.fields[now]}"),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task(description, total=1.0, now="")
        yield lambda share, text: bar.update(task, completed=share, now=text)


def print_criteria(page: Console, criteria: tuple[CriterionResult, ...]) -> None:
    """Criteria with value, limits, margin and verdict; below, why some could not be judged."""
    page.print(_table(criteria))
    for reason in _reasons(criteria):
        page.print(f"  {reason}", highlight=False, markup=False, soft_wrap=True)


def _table(criteria: tuple[CriterionResult, ...]) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("criterion", no_wrap=True)
    for name in ("value", "limit", "margin"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for c in criteria:
        limits = [f"≥ {c.lower:.4g}"] if c.lower is not None else []
        limits += [f"≤ {c.upper:.4g}"] if c.upper is not None else []
        table.add_row(
            c.id,
            f"{c.value:.4g}" if c.value is not None else "-",
            " ".join(limits) or "-",
            f"{c.margin:.4g}" if c.margin is not None else "-",
            c.unit,
            f"[{_STYLE[c.verdict]}]{c.verdict}[/]",
        )
    return table


def _reasons(criteria: tuple[CriterionResult, ...]) -> list[str]:
    """Why criteria could not be judged, each reason once."""
    found: dict[str, int] = {}
    for c in criteria:
        if c.reason:
            found[c.reason] = found.get(c.reason, 0) + 1
    return [f"{count} not judged: {reason}" for reason, count in found.items()]
