"""A campaign executed: what is missing is handed out in batches, what comes back is put on disk."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

#: What is known of one simulation; `simulation` is its number.
Row = dict[str, Any]
#: Makes the rows of simulations `first` to `last`.
MakeRows = Callable[[int, int], list[Row]]

#: What a batch takes: long beside handing it out and writing its file, short beside what a kill may cost.
BATCH_S = 3.0
_BATCHES_PER_WORKER = 4  # at least, so that none has nothing to do for long while another ends


@dataclass(frozen=True)
class Batch:
    """Simulations `first` to `last`, both included."""

    first: int
    last: int

    def __len__(self) -> int:
        return self.last - self.first + 1


#: A batch with its rows; without rows, a single simulation that ends its process.
Done = tuple[Batch, list[Row] | None]


class Kept(Protocol):
    """Where rows are put in batches that are there whole or not at all: what is there is the state."""

    def __iter__(self) -> Iterator[Batch]:
        """All batches, there or not."""

    def missing(self) -> list[Batch]:
        """Those that are not there."""

    def holding(self, batch: Batch) -> Batch:
        """The one that a batch or a part of one belongs to."""

    def write(self, batch: Batch, rows: list[Row]) -> None:
        """Put all of one's rows there."""


class Carriers(Protocol):
    """Whoever carries batches out."""

    @property
    def wanted(self) -> int:
        """How many more batches keep everybody busy."""

    @property
    def under_way(self) -> int:
        """Batches that are handed out."""

    def submit(self, batch: Batch) -> None:
        """Hand a batch out."""

    def keep_running_only(self) -> None:
        """Take back what no one has started."""

    def done(self) -> Iterator[Done]:
        """What has ended since."""


class Here:
    """Carries batches out in this process, one at a time."""

    wanted = 1

    def __init__(self, make: MakeRows) -> None:
        self._make = make
        self._out: deque[Batch] = deque()

    @property
    def under_way(self) -> int:
        """Batches that are handed out."""
        return len(self._out)

    def submit(self, batch: Batch) -> None:
        """Hand a batch out."""
        self._out.append(batch)
        self.wanted = 0

    def keep_running_only(self) -> None:
        """None is started between two of them."""
        self._out.clear()

    def done(self) -> Iterator[Done]:
        """Carry the oldest out."""
        if self._out:
            batch = self._out.popleft()
            self.wanted = 1
            yield batch, self._make(batch.first, batch.last)


def batch_size(count: int, one_s: float, workers: int) -> int:
    """How many of `count` simulations, each of `one_s` seconds, make a batch."""
    by_time = math.ceil(BATCH_S / max(one_s, 1e-3))
    by_share = math.ceil(count / (_BATCHES_PER_WORKER * max(1, workers)))
    return max(1, min(by_time, by_share))


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
