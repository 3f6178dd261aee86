"""How long a search may take: an answer that says less is better than none."""

from __future__ import annotations

import math
import time

from hil.analysis.diagnosis.fit._thresholds import LOOK_S


class OutOfTimeError(Exception):
    """A search has used up what it was allowed."""


class Allowance:
    """Processor time of this process that a search may take, in s, from now on.

    Processor time and not the clock on the wall: a busy machine shall not change what is found.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self._ends = time.process_time() + seconds
        self._looks_again = -math.inf

    def check(self) -> None:
        """Go on, or not.

        Raises:
            OutOfTimeError: all of it is used up.
        """
        now = time.perf_counter()
        if now < self._looks_again:
            return
        if time.process_time() > self._ends:
            raise OutOfTimeError
        self._looks_again = now + LOOK_S

    def lift(self) -> None:
        """Let what comes now take as long as it takes."""
        self._ends = math.inf


#: For who may take as long as it takes.
UNBOUNDED = Allowance()
