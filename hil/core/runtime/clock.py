"""Time as an argument: a bench has a wall clock, a simulation one in which waiting means computing."""

from __future__ import annotations

import datetime
import time
from typing import Protocol


def utc(since_1970_ns: int) -> str:
    """A moment as ISO 8601, to the millisecond and with its zone."""
    moment = datetime.datetime.fromtimestamp(since_1970_ns // 1_000_000 / 1e3, datetime.UTC)
    return moment.isoformat(timespec="milliseconds")


class Clock(Protocol):
    """What the engine and the drivers know of time."""

    @property
    def virtual(self) -> bool:
        """Whether waiting only means computing, so that several ticks may pass in one call."""
        ...

    def now_s(self) -> float:
        """Seconds since the bench was opened."""
        ...

    def sleep_until(self, time_s: float) -> None:
        """Return when `now_s()` has reached `time_s`; at once if it has already."""
        ...


class WallClock:
    """Monotonic real time.

    Args:
        scale: seconds of this clock in a second of real time; less than 1 for a simulated bench in a process
            of its own that cannot keep up.
    """

    virtual = False

    def __init__(self, scale: float = 1.0) -> None:
        self._start, self._scale = time.monotonic(), scale

    def now_s(self) -> float:
        """Seconds since this clock was made."""
        return (time.monotonic() - self._start) * self._scale

    def sleep_until(self, time_s: float) -> None:
        """Sleep; the last part of a millisecond is left to the operating system's timer."""
        remaining = time_s - self.now_s()
        if remaining > 0:
            time.sleep(remaining / self._scale)
