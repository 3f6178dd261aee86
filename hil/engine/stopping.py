"""Asking a run to stop: Ctrl-C, a termination, a closed terminal. Asking never interrupts what makes safe."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType

#: SIGHUP is a closed terminal; Windows has none.
STOP_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


class StopRequest:
    """How often somebody asked to stop; whoever works is told at once and decides when it can."""

    def __init__(self) -> None:
        self.times = 0
        self._told: Callable[[], None] = lambda: None

    def ask(self) -> None:
        """Ask to stop; safe to call from a signal handler and again."""
        self.times += 1
        self._told()

    @contextlib.contextmanager
    def telling(self, told: Callable[[], None]) -> Iterator[None]:
        """Call `told` whenever somebody asks, and now if somebody already has."""
        before, self._told = self._told, told
        if self.times:
            told()
        try:
            yield
        finally:
            self._told = before

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
        for number in STOP_SIGNALS:
            if number == signal.SIGINT or signal.getsignal(number) is not signal.SIG_IGN:
                previous[number] = signal.signal(number, on_signal)
        try:
            yield
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)
