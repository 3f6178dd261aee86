"""A campaign executed: what is missing is handed out, what comes back is put on disk."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from hil.campaign._batches import Batch, Carriers, Kept, Row

_AWAITED_S = 60.0  # at most, for what is under way when somebody stops it: its worker may be gone
_KILLED = "the process that simulated it died each time"


@dataclass(frozen=True)
class Progress:
    """How far a campaign is: simulations on disk, of how many, how many a second come, seconds left."""

    done: int
    of: int
    rate_hz: float
    left_s: float

    def __str__(self) -> str:
        """For people."""
        if not self.rate_hz:
            return f"{self.done} of {self.of}"
        minutes, seconds = divmod(round(self.left_s), 60)
        left = f"{minutes} min {seconds:02d} s" if minutes else f"{seconds} s"
        return f"{self.done} of {self.of}, {self.rate_hz:.1f}/s, {left} left"


def execute(
    parts: Kept,
    carriers: Carriers,
    failed: Callable[[int, str], Row],
    *,
    show: Callable[[Progress], None] = lambda progress: None,
    stopped: Callable[[], bool] = lambda: False,
) -> bool:
    """Execute what is missing; once `stopped`, only what is under way is awaited.

    Args:
        failed: makes the row of one that ends whatever process carries it out.

    Returns:
        whether every simulation is on disk.

    Raises:
        HilError: no one can execute them, or the disk is full; what was done is on disk.
    """
    missing = deque(parts.missing())
    total = sum(len(batch) for batch in parts)
    done = before = total - sum(len(batch) for batch in missing)
    gathered: dict[int, list[Row]] = {}
    begun_s, until_s = time.monotonic(), math.inf
    show(Progress(done, total, 0.0, 0.0))
    while (missing or carriers.under_way) and time.monotonic() < until_s:
        if stopped() and until_s == math.inf:
            until_s = time.monotonic() + _AWAITED_S
            missing.clear()
            carriers.keep_running_only()
        for _ in range(carriers.wanted if missing else 0):
            if missing:
                carriers.submit(missing.popleft())
        for batch, rows in carriers.done():
            if rows is None:
                rows = [failed(batch.first, _KILLED)]
            done += _kept(parts, batch, rows, gathered)
            rate = (done - before) / (time.monotonic() - begun_s)
            show(Progress(done, total, rate, (total - done) / rate if rate else 0.0))
    return done == total


def _kept(parts: Kept, batch: Batch, rows: list[Row], gathered: dict[int, list[Row]]) -> int:
    """Put rows on disk once their part file has all of them; how many were put there."""
    whole = parts.holding(batch)
    there = gathered.setdefault(whole.first, [])
    there += rows
    if len(there) < len(whole):
        return 0
    parts.write(whole, sorted(gathered.pop(whole.first), key=lambda row: int(row["simulation"])))
    return len(whole)
