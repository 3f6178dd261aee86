"""How long a search may take: an answer that says less is better than none."""

from __future__ import annotations

import math
import time

INTERRUPTED, OUT_OF_TIME = "interrupted", "out of time"
"""Why a search ended before it was through."""


class OutOfTimeError(Exception):
    """A search has used up what it was allowed."""


class Allowance:
    """Processor time of this process that a search may take, in s, from now on.

    Processor time and not the clock on the wall: a busy machine shall not change what is found.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self._ends = time.process_time() + seconds

    def check(self) -> None:
        """Go on, or not.

        Raises:
            OutOfTimeError: all of it is used up.
        """
        if time.process_time() > self._ends:
            raise OutOfTimeError

    def lift(self) -> None:
        """Let what comes now take as long as it takes."""
        self._ends = math.inf


#: For who may take as long as it takes.
UNBOUNDED = Allowance()
