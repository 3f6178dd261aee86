"""Asking a run to stop: Ctrl-C, a termination, a closed terminal. Asking never interrupts what makes safe."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType

from hil.core.channels import ENDING_SIGNALS


@contextlib.contextmanager
def held_back() -> Iterator[None]:
    """Keep the signals until this is left; a process started meanwhile keeps its own until `hear_signals`."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING_SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def hear_signals() -> None:
    """Take the signals that were held back, and those to come."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING_SIGNALS)


class StopRequest:
    """How often somebody asked to stop; whoever works is reported at once and decides when it can."""

    def __init__(self) -> None:
        self.times = 0
        self._callback: Callable[[], None] = lambda: None

    def ask(self) -> None:
        """Ask to stop; safe to call from a signal handler and again."""
        self.times += 1
        self._callback()

    @contextlib.contextmanager
    def telling(self, callback: Callable[[], None]) -> Iterator[None]:
        """Call `callback` whenever somebody asks, and now if somebody already has."""
        before, self._callback = self._callback, callback
        if self.times:
            callback()
        try:
            yield
        finally:
            self._callback = before

    @contextlib.contextmanager
    def by_signals(self) -> Iterator[None]:
        """Take the signals that would end the process as a request; may be nested.

        Only the main thread can do this; in any other it changes nothing. A SIGHUP that is ignored
        (`nohup`) stays so.
        """
        if threading.current_thread() is not threading.main_thread():
            yield
            return

        def on_signal(number: int, frame: FrameType | None) -> None:
            del number, frame
            self.ask()

        previous = {}
        for number in ENDING_SIGNALS:
            if number == signal.SIGINT or signal.getsignal(number) is not signal.SIG_IGN:
                previous[number] = signal.signal(number, on_signal)
        try:
            yield
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)
