"""A clock for tests that goes when somebody waits for it."""

from __future__ import annotations


class SteppedClock:
    """Waiting takes no time. It may say that it is no virtual one: then all is done tick by tick.

    Args:
        oversleeps_s: so much longer than asked for everybody sleeps.
    """

    def __init__(self, *, virtual: bool = True, oversleeps_s: float = 0.0) -> None:
        self.virtual = virtual
        self.time_s = 0.0
        self._oversleeps_s = oversleeps_s

    def now_s(self) -> float:
        return self.time_s

    def sleep_until(self, time_s: float) -> None:
        self.time_s = max(self.time_s, time_s + self._oversleeps_s)
