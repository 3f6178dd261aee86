"""What a use case reports while it works, to whoever asked for it."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from hil.core.recording import Recording
    from hil.engine.ipc.ipc import Terminal

logger = logging.getLogger(__name__)

COMPILING = "compiling for this machine, once: a minute or two"
_COMPILER = "hil.core.runtime.compiled"  # named here, for importing it takes longer than most commands


class Show(Protocol):
    """Shows what is being done, and how much of it is done if that is known (0 to 1)."""

    def __call__(self, text: str, share: float | None = None) -> None:
        """Show it."""


class Feedback(Protocol):
    """Where a use case reports to, and who answers there: a terminal, a service, a log.

    Attributes:
        keys: what the operator may type during a run, for the progress line.
    """

    keys: str

    @property
    def can_ask(self) -> bool:
        """Whether somebody is there who could answer a question."""

    def progress(self, description: str) -> AbstractContextManager[Show]:
        """Show the progress of a part of the work."""

    def note(self, text: str) -> None:
        """Report what was decided or skipped."""

    def warn(self, text: str) -> None:
        """Report what a person must know though the work goes on."""

    def complain(self, text: str) -> None:
        """Report an error that the outcome also has."""

    def ask_name(self, question: str, given: str) -> str:
        """Show a question that a name answers; the name that is given, else the one that is typed, or ''."""

    def terminal(self) -> Terminal | None:
        """The operator's terminal for the length of a run; None where no one sits at one."""


class LoggedFeedback:
    """Feedback for callers that show nothing: everything goes to the log, and no one answers."""

    keys = ""
    can_ask = False

    @contextlib.contextmanager
    def progress(self, description: str) -> Iterator[Show]:
        """Log each text once."""
        last = ""

        def show(text: str, share: float | None = None) -> None:
            del share
            nonlocal last
            if text != last:
                last = text
                logger.info("%s: %s", description, text)

        yield show

    def note(self, text: str) -> None:
        """Log it."""
        logger.info(text)

    def warn(self, text: str) -> None:
        """Log it."""
        logger.warning(text)

    def complain(self, text: str) -> None:
        """Log it."""
        logger.error(text)

    def ask_name(self, question: str, given: str) -> str:
        """Log the question."""
        logger.info(question)
        return given

    def terminal(self) -> Terminal | None:
        """No one's."""
        return None


LOGGED: Feedback = LoggedFeedback()


@contextlib.contextmanager
def telling_of_compilation(say: Callable[[str], None]) -> Iterator[None]:
    """Say why nothing moves for a while, when a function is compiled here or in the process of the bench."""
    lines = _EachLine(lambda: say(COMPILING))
    compiler = logging.getLogger(_COMPILER)
    compiler.addHandler(lines)
    try:
        yield
    finally:
        compiler.removeHandler(lines)


class _EachLine(logging.Handler):
    """Calls for each line."""

    def __init__(self, tell: Callable[[], None]) -> None:
        super().__init__(logging.INFO)
        self._tell = tell

    def emit(self, record: logging.LogRecord) -> None:
        """Whatever is compiled."""
        del record
        self._tell()


def warn_of_damage(feedback: Feedback, recordings: Iterable[Recording]) -> None:
    """Report what of recordings was lost or cannot be trusted."""
    for recording in recordings:
        for sentence in recording.damage:
            feedback.warn(f"{recording.source}: {sentence}")
