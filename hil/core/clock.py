"""Time as an argument: a bench has a wall clock, a simulation one in which waiting means computing."""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    """What the engine and the drivers know of time."""

    def now_s(self) -> float:
        """Seconds since the bench was opened."""
        ...

    def sleep_until(self, time_s: float) -> None:
        """Return when `now_s()` has reached `time_s`; at once if it has already."""
        ...


class WallClock:
    """Monotonic real time."""

    def __init__(self) -> None:
        self._start = time.monotonic()

    def now_s(self) -> float:
        """Seconds since this clock was made."""
        return time.monotonic() - self._start

    def sleep_until(self, time_s: float) -> None:
        """Sleep; the last part of a millisecond is left to the operating system's timer."""
        remaining = time_s - self.now_s()
        if remaining > 0:
            time.sleep(remaining)
