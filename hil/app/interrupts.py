"""Signals that end a command: Ctrl-C, a termination, a closed terminal are one and the same to it."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import time
from collections.abc import Callable
from types import FrameType
from typing import TYPE_CHECKING

from hil.core.channels import ENDING_SIGNALS

if TYPE_CHECKING:
    from hil.engine import StopRequest

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
