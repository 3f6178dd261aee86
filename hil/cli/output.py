"""What commands print: tables for people, one JSON object for programs, progress for terminals."""

from __future__ import annotations

import contextlib
import datetime
import logging
import sys
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from hil.app.feedback import LOGGED, Show, telling_of_compilation
from hil.app.log import LOG
from hil.app.result_file import to_json
from hil.cli.streams import KEYS, complain, operators_terminal
from hil.core.errors.wording import printable, share
from hil.core.result import AcceptedExpiry, CriterionResult, CriterionVerdict, Identity

logger = logging.getLogger(__name__)

_LEAST_SHARE, _LEAST_ELAPSED_S = 0.02, 2.0  # from which on a pace is known

_STYLE: dict[CriterionVerdict, str] = {
    "pass": "green",
    "fail": "bold red",
    "undecided": "bold yellow",
    "informational": "dim",
    "did_not_settle": "yellow",
    "not_judged": "magenta",
    "error": "bold magenta",
}


def print_json(value: Mapping[str, Any]) -> None:
    """The one JSON object of `--json`; on a stream that is not Unicode, with escapes."""
    unicode = (sys.stdout.encoding or "ascii").lower().startswith("utf")
    print(to_json(value, ascii_only=not unicode))


def console() -> Console:
    """Standard output for people; in a pipe wide enough not to break a table."""
    return Console(soft_wrap=False) if sys.stdout.isatty() else Console(width=140)


def local_time(moment: datetime.datetime | None) -> str:
    """A moment to the second in this machine's time zone; a dash for none."""
    return "-" if moment is None else moment.astimezone().isoformat(" ", "seconds")[:19]


def time_zone() -> str:
    """This machine's, as an offset from UTC: +01:00."""
    return datetime.datetime.now().astimezone().isoformat()[-6:]


def plain_table(title: str | None = None) -> Table:
    """A table without lines, its columns still to come."""
    return Table(box=None, pad_edge=False, header_style="bold", title=title, title_justify="left")


def note(text: str) -> None:
    """What is being done between two lines of progress; a line on a terminal, nothing in a pipe."""
    logger.info(text)
    if sys.stderr.isatty() and not LOG.verbose:
        complain("now", text)


def warn(text: str) -> None:
    """What a person must know though the command goes on; on standard error."""
    logger.warning(text)
    complain("warning", text)


@contextlib.contextmanager
def progress(description: str) -> Iterator[Show]:
    """A line on a terminal, nothing in a pipe; with --verbose the log has it."""
    with LOGGED.progress(description) as log:
        if LOG.verbose or not sys.stderr.isatty():
            yield log
        else:
            yield from _bar(description, log)


class _Terminal:
    """Feedback of a use case on standard error, and the person at standard input."""

    keys = KEYS
    progress = staticmethod(progress)
    note = staticmethod(note)
    warn = staticmethod(warn)

    @staticmethod
    def complain(text: str) -> None:
        """An error that ends nothing here."""
        complain("error", text)

    @property
    def can_ask(self) -> bool:
        """Whether a person sits at standard input."""
        return sys.stdin.isatty()

    def ask_name(self, question: str, given: str) -> str:
        """Print the question; read a line if no name is given."""
        print(question, file=sys.stderr)
        return given or sys.stdin.readline().strip()

    terminal = staticmethod(operators_terminal)


TERMINAL = _Terminal()


def _bar(description: str, log: Show) -> Iterator[Show]:
    bar = Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.fields[now]}", markup=False),
        TimeElapsedColumn(),
        TextColumn("{task.fields[left]}", markup=False),
        console=Console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task(description, total=None, now="", left="")

        def show(text: str, share: float | None = None) -> None:
            log(text, share)
            left = time_left(share, bar.tasks[0].elapsed or 0.0)
            bar.update(
                task, total=None if share is None else 1.0, completed=share or 0.0, now=text, left=left
            )

        with telling_of_compilation(lambda text: bar.update(task, now=text)):
            yield show


def time_left(share: float | None, elapsed_s: float) -> str:
    """How much is done and how long the rest takes at the pace so far; '' while that is not known."""
    if share is None:
        return ""
    if share < _LEAST_SHARE or elapsed_s < _LEAST_ELAPSED_S:
        return f"{share:.0%}"
    left_s = elapsed_s * (1.0 - share) / share
    left = f"{left_s:.0f} s" if left_s < 2 * 60 else f"{left_s / 60:.0f} min"
    return f"{share:.0%}, about {left} left"


def print_criteria(page: Console, criteria: tuple[CriterionResult, ...]) -> None:
    """Criteria with value, limits, margin and verdict; below, why some have no value.

    Of the checks that any device must pass only those that it did not are shown.
    """
    shown = tuple(c for c in criteria if c.source == "plan" or c.verdict != "pass")
    if shown:
        page.print(_table(shown))
    for reason in _reasons(shown):
        page.print(f"  {reason}", highlight=False, markup=False, soft_wrap=True)


def count_in_words(criteria: tuple[CriterionResult, ...]) -> str:
    """How many criteria with a limit passed, and what became of the others."""
    parts = []
    for source, name in (("plan", "criteria"), ("device", "device checks")):
        judged = [c for c in criteria if c.has_limit and c.source == source]
        passed, failed = sum(c.verdict == "pass" for c in judged), sum(c.failed for c in judged)
        parts += [f"{passed} of {len(judged)} {name} passed"] if judged and not failed else []
        parts += [f"{failed} of {len(judged)} {name} failed"] if failed else []
        unjudged = len(judged) - passed - failed
        parts += [f"{unjudged} could not be evaluated"] if unjudged else []
    parts = parts or ["no criterion was evaluated"]
    informational = sum(c.verdict == "informational" for c in criteria)
    return ", ".join([*parts, f"{informational} informational"] if informational else parts)


def expiry_in_words(accepted: AcceptedExpiry) -> str:
    """Which sensors measured although their calibration had run out, and who answers for it."""
    sensors = ", ".join(f"{printable(name, 60)} (until {until})" for name, until in accepted.sensors.items())
    by, reason = printable(accepted.by, 100), printable(accepted.reason, 400)
    return f"calibration expired: {sensors}; accepted by {by}: {reason}"


def identities_in_words(identities: Iterable[Identity]) -> str:
    """Software and calibration of each device, on a line: "rmcu software 1.0.0, calibration 0DA2024A"."""
    facts: dict[str, dict[str, None]] = {}
    for identity in identities:
        name = identity.name.rpartition(": ")[2]
        if name in ("software", "calibration") and identity.value:
            facts.setdefault(identity.device, {})[f"{name} {printable(identity.value, 60)}"] = None
    return "; ".join(f"{device} {', '.join(values)}" for device, values in facts.items())


def _table(criteria: tuple[CriterionResult, ...]) -> Table:
    table = plain_table()
    table.add_column("criterion", no_wrap=True)
    for name in ("value", "limit", "margin"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for c in criteria:
        limits = [f"≥ {c.lower:.4g}"] if c.lower is not None else []
        limits += [f"≤ {c.upper:.4g}"] if c.upper is not None and not c.below else []
        limits += [f"< {c.upper:.4g}"] if c.upper is not None and c.below else []
        table.add_row(
            c.id,
            f"{c.value:.4g}" if c.value is not None else "-",
            " ".join(limits) or "-",
            share(c.margin) if c.margin is not None else "-",
            c.unit,
            f"[{_STYLE[c.verdict]}]{c.verdict.replace('_', ' ')}[/]",
        )
    return table


def _reasons(criteria: tuple[CriterionResult, ...]) -> list[str]:
    """Why criteria have no value, each reason once."""
    found: dict[tuple[str, str], int] = {}
    for c in criteria:
        if c.reason:
            key = (c.verdict.replace("_", " "), c.reason)
            found[key] = found.get(key, 0) + 1
    return [
        f"{f'{count} ' if count > 1 else ''}{verdict}: {reason}" for (verdict, reason), count in found.items()
    ]
