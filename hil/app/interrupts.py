"""How a use case ends: by signals, or by an error with what, where and what to do.

Ctrl-C, a termination and a closed terminal are one and the same to a command.
"""

from __future__ import annotations

import contextlib
import logging
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from hil.core.channels import ENDING_SIGNALS
from hil.core.errors import BenchError, HilError
from hil.core.errors.extras import not_installed
from hil.core.files import of_the_system

if TYPE_CHECKING:
    from hil.engine import StopRequest

logger = logging.getLogger(__name__)


def error_of(error: Exception) -> HilError:
    """The error to be shown for any exception; a mistake of the program is logged with its traceback."""
    if isinstance(error, HilError):
        logger.debug("ended by", exc_info=error)
        return error
    if isinstance(error, OSError):
        return of_the_system(error)
    if isinstance(error, ModuleNotFoundError):
        return not_installed(error) or _internal(error)
    if isinstance(error, MemoryError):
        return _too_little_memory()
    return _internal(error)


def _too_little_memory() -> BenchError:
    limit, _ = resource.getrlimit(resource.RLIMIT_DATA)  # a service sets one for what it begins
    limited = f", which may use {limit / 1e9:.3g} GB" if limit != resource.RLIM_INFINITY else ""
    return BenchError(
        f"there is not enough memory for this command{limited}", fix="use a shorter recording or plan"
    )


def _internal(error: Exception) -> BenchError:
    """Where the mistake was; its traceback is in the log, for whoever mends it."""
    logger.error("internal error", exc_info=error)
    at = traceback.extract_tb(error.__traceback__)[-1]
    return BenchError(
        f"internal error: {type(error).__name__}: {error}",
        where=f"{Path(at.filename).name}:{at.lineno}",
        fix="please report it with the log, the command and its input",
    )


EXIT_CODE = 130
_AT_ONCE_S = 0.002  # no one presses a key twice so fast


class Interrupts:
    """Raises KeyboardInterrupt for each signal, and remembers that there was one.

    A signal that comes within a moment of the one before is the same one: `timeout`, for one, sends it both
    to the process and to its group.
    What a library makes of an exception in the middle of an import is anybody's guess; `arrived` is not.
    """

    def __init__(self) -> None:
        self.arrived = False
        self._told = False
        self._last_s = -_AT_ONCE_S
        self._unraisable = sys.unraisablehook

    def raise_from_now_on(self) -> None:
        """Take the signals; a SIGHUP that is ignored (`nohup`) stays so."""
        for number in ENDING_SIGNALS:
            if number == signal.SIGINT or signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._on_signal)

    def ignore_from_now_on(self) -> None:
        """The outcome is settled: what comes now changes nothing."""
        for number in ENDING_SIGNALS:
            signal.signal(number, signal.SIG_IGN)

    def answered(self) -> None:
        """Somebody has taken the signal for what it is, and says so in words of its own."""
        self.arrived = False
        sys.unraisablehook = self._unraisable

    def tell(self) -> None:
        """Say it, once."""
        if not self._told:
            self._told = True
            with contextlib.suppress(OSError):
                os.write(2, b"error: interrupted\n")

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        del number, frame
        now_s = time.monotonic()
        again, self._last_s = now_s - self._last_s < _AT_ONCE_S, now_s
        if again:
            return
        if not self.arrived:
            self.arrived = True
            # What was made in part complains as it is thrown away: no one's news.
            self._unraisable, sys.unraisablehook = sys.unraisablehook, _say_nothing
        raise KeyboardInterrupt


def _say_nothing(unraisable: object) -> None:
    """In place of a traceback."""
    del unraisable


INTERRUPTS = Interrupts()


def end_at_second(stop: StopRequest) -> Callable[[], None]:
    """For `stop.telling`: after one Ctrl-C the result so far is still written, a second one ends it."""

    def asked() -> None:
        if stop.times > 1:
            INTERRUPTS.arrived = True
            raise KeyboardInterrupt

    return asked
