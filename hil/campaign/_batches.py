"""Which simulations are done together, and who does them."""

from __future__ import annotations

import math
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
