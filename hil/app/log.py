"""The log of a command: nothing unless it is asked for, or unless something unexpected happens.

Modules log to loggers of their own names; this is the one place where it is stated what becomes of that.
"""

from __future__ import annotations

import logging
import os
import platform
import shlex
import sys
import tempfile
import time
from collections import deque
from collections.abc import Sequence
from pathlib import Path

from hil.core.channels import PACKAGES
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import of_the_system, refuse_special

_HEAD = "# log of hil"
_LINES_KEPT = 2000
_LONGEST_LINE = 2000

logger = logging.getLogger(__name__)


class Log:
    """What a command did, to a file and to standard error as asked; the last lines are kept in any case.

    What is logged as an error with its traceback is a mistake of the program: no one expected it.
    """

    def __init__(self) -> None:
        self._recent = _Recent()
        self._handlers: list[logging.Handler] = []
        self._file: Path | None = None
        self.verbose = False

    @property
    def faulty(self) -> bool:
        """Whether an exception was logged as an error."""
        return self._recent.faulty

    def begin(self, arguments: Sequence[str]) -> None:
        """Keep the last lines from here on, of a command line with `arguments`."""
        self.end()
        logging.raiseExceptions = False  # a log that cannot be written must not cost a run its output
        self._recent = _Recent()
        self._file, self.verbose = None, False
        for name in PACKAGES:
            logging.getLogger(name).setLevel(logging.DEBUG)
        self._add(self._recent, logging.DEBUG)
        logging.captureWarnings(capture=True)  # what libraries warn of is for the log
        logger.info("hil %s", shlex.join(arguments))
        logger.debug("Python %s on %s", platform.python_version(), sys.platform)

    def send(self, file: Path | None, *, verbose: bool) -> None:
        """Write to `file` from the first line on, and to standard error if `verbose`.

        Raises:
            BadInputError: `file` cannot be written, or is something other than a log.
        """
        self.verbose = verbose
        if verbose:
            stream = logging.StreamHandler(sys.stderr)
            self._add(stream, logging.INFO)
        if file is not None:
            _refuse_unless_log(file)
            try:
                file.write_text("\n".join([_HEAD, *self._recent.lines, ""]), "utf-8", "backslashreplace")
                self._add(
                    logging.FileHandler(file, encoding="utf-8", errors="backslashreplace"), logging.DEBUG
                )
            except OSError as error:
                raise of_the_system(error) from error
            self._file = file

    def kept(self) -> Path | None:
        """The file with what happened; made now if none was asked for, None if that cannot be."""
        if self._file is None:
            name = f"hil-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.log"
            path = Path(tempfile.gettempdir()) / name
            try:
                with path.open("x", encoding="utf-8", errors="backslashreplace") as file:
                    file.write("\n".join([_HEAD, *self._recent.lines, ""]))
            except OSError:
                return None
            self._file = path
        return self._file

    def end(self) -> None:
        """Close the file."""
        logging.captureWarnings(capture=False)
        for handler in self._handlers:
            logging.getLogger().removeHandler(handler)
            handler.close()
        self._handlers = []

    def _add(self, handler: logging.Handler, level: int) -> None:
        handler.setLevel(level)
        handler.setFormatter(_Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s"))
        logging.getLogger().addHandler(handler)
        self._handlers.append(handler)


class _Formatter(logging.Formatter):
    """Lines without what would move a terminal's cursor: names of files and devices are in them."""

    def format(self, record: logging.LogRecord) -> str:
        lines = super().format(record).split("\n")
        return "\n".join(printable(line, longest=_LONGEST_LINE) for line in lines)


class _Recent(logging.Handler):
    """The last lines."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: deque[str] = deque(maxlen=_LINES_KEPT)
        self.faulty = False

    def emit(self, record: logging.LogRecord) -> None:
        """Keep it."""
        self.lines.append(self.format(record))
        self.faulty |= bool(record.exc_info) and record.levelno >= logging.ERROR


def _refuse_unless_log(path: Path) -> None:
    """A log may take the place of an earlier log, and of nothing else."""
    refuse_special(path)
    if not path.exists():
        return
    try:
        with path.open("rb") as file:
            head = file.read(len(_HEAD))
    except OSError as error:
        raise of_the_system(error) from error
    if head not in (b"", _HEAD.encode()):
        raise BadInputError(
            "exists and is not a log file", where=str(path), fix="give another file with --log"
        )


LOG = Log()
