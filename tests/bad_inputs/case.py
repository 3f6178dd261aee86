"""One thing to try on a command, and what came of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

DONE, FAILED, REFUSED, BENCH, INTERRUPTED = 0, 1, 2, 3, 130  # exit codes of the contract
FINISHED = (DONE, FAILED)

#: Kinds of what is tried, in the order of the page.
FILES, BOUNDS, VALUES, OPTIONS, PLACES, SIGNALS, STREAMS = (
    "files",
    "bounds",
    "values",
    "options",
    "places",
    "signals",
    "streams",
)


@dataclass(frozen=True)
class Interruption:
    """Signals to send: `names` one after the other, after `after_s`, or once `when_there` exists."""

    names: tuple[str, ...]
    after_s: float = 0.0
    when_there: str = ""


@dataclass(frozen=True)
class Case:
    """What is tried: a command line in a folder of its own that holds a copy of the inputs.

    `shell` is a bash line around the command line ("$@"); `prepare` changes the folder before.
    `results` are the names that the command may leave in `out`, all or none where `together`.
    """

    command: str
    kind: str
    tried: str
    arguments: tuple[str, ...]
    allowed: tuple[int, ...]
    prepare: Callable[[Path], None] | None = None
    shell: str = ""
    environment: dict[str, str] = field(default_factory=dict)
    interruption: Interruption | None = None
    silent: bool = False  # standard error is closed or full: no message can be seen
    deaf: bool = False  # standard output is closed, full or cut: nothing can be seen there

    @property
    def as_json(self) -> bool:
        """Whether standard output is for a program."""
        return "--json" in self.arguments


@dataclass(frozen=True)
class Outcome:
    """What a case did: `code` is None when it had to be ended after the time limit."""

    code: int | None
    out: str
    err: str
    new: tuple[str, ...]  # paths, relative to the case's folder
    changed: tuple[str, ...]  # inputs that are not as they were
    broken: tuple[str, ...]  # new files that are not whole
    seconds: float = 0.0
    megabytes: float = 0.0  # resident, at most
