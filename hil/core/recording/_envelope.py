"""Lowest and highest values of a whole recording in equal buckets, and where its samples lie.

A plot of an hour has two thousand places for 3.6 million samples. What it shows is the lowest and the highest
value in each, so that no peak is lost, and those are taken from buckets that were filled once, as the samples
came. Where a plot is closer than these buckets are wide, the samples of that stretch alone are read.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.recording._stored import RowReader

#: Buckets begin this wide; whenever there are MOST_BUCKETS of them, two become one.
FINEST_S = 0.02
MOST_BUCKETS = 1 << 18
_FIRST_ROOM = 1 << 10

Array = npt.NDArray[np.float64]
Low = npt.NDArray[np.float32]


@dataclass(frozen=True)
class RowPart:
    """Rows that stand together in the file at `position`, and times of the first and the last in s."""

    position: int
    count: int
    first_s: float
    last_s: float


@dataclass(frozen=True)
class Stretch:
    """Lowest and highest values by channel in buckets of `width_s` from `start_s`; NaN where nothing came."""

    start_s: float
    width_s: float
    lowest: dict[str, Array]
    highest: dict[str, Array]


@dataclass(frozen=True)
class Envelope:
    """What was measured until now.

    Attributes:
        names: of the channels, without the time.
        width_s: of a bucket; bucket 0 begins at `first` times that.
        lowest, highest: shape (channels, buckets).
        parts: where the rows lie, in order; empty where that is not known.
        sample_time_s: usual distance of samples; NaN for fewer than two.
    """

    names: tuple[str, ...]
    width_s: float
    first: int
    lowest: Low
    highest: Low
    parts: Sequence[RowPart]
    first_s: float
    last_s: float
    sample_time_s: float

    def stretch(self, names: Sequence[str], start_s: float, end_s: float, most: int) -> Stretch:
        """Channels between two times in at most `most` buckets, each a power of two of those that are kept.

        Raises:
            KeyError: there is no such channel.
        """
        missing = [name for name in names if name not in self.names]
        if missing:
            raise KeyError(missing[0])
        last = self.first + self.lowest.shape[1]
        start_s, end_s = max(start_s, self.first * self.width_s), min(end_s, last * self.width_s)
        joined = _power_of_two((end_s - start_s) / (self.width_s * max(1, most - 1)))
        width_s = joined * self.width_s
        begin = max(math.floor(start_s / width_s + 1e-9), self.first // joined) * joined
        end = min(math.ceil(end_s / width_s - 1e-9), -(-last // joined)) * joined
        rows = [self.names.index(name) for name in names]
        there = slice(max(begin, self.first) - self.first, max(0, min(end, last) - self.first))
        beside = (max(0, self.first - begin), max(0, end - last))
        low = _joined(self.lowest[rows, there], joined, beside, np.fmin)
        high = _joined(self.highest[rows, there], joined, beside, np.fmax)
        return Stretch(
            begin * self.width_s,
            width_s,
            {name: np.asarray(low[at], float) for at, name in enumerate(names)},
            {name: np.asarray(high[at], float) for at, name in enumerate(names)},
        )

    def samples_between(self, start_s: float, end_s: float) -> int:
        """How many rows have to be read for a stretch of time."""
        return sum(part.count for part in self._parts_between(start_s, end_s))

    def rows(self, read: RowReader, start_s: float, end_s: float) -> Array:
        """All samples between two times, both included, shape (samples, 1 + channels), time stamps first.

        Raises:
            BadInputError: the file is not what it was.
        """
        found = [read(part.position, part.count) for part in self._parts_between(start_s, end_s)]
        rows = np.concatenate(found) if found else np.zeros((0, 1 + len(self.names)))
        return rows[(rows[:, 0] >= start_s) & (rows[:, 0] <= end_s)]

    def _parts_between(self, start_s: float, end_s: float) -> Sequence[RowPart]:
        begin = bisect.bisect_left(self.parts, start_s, key=lambda part: part.last_s)
        end = bisect.bisect_right(self.parts, end_s, key=lambda part: part.first_s)
        return self.parts[begin:end]


class EnvelopeBuilder:
    """Fills the buckets of an envelope as samples come: 32 MB of 16 channels at most."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = tuple(names)
        self._width_s = FINEST_S
        self._first: int | None = None
        self._count = 0
        self._low = np.full((len(self._names), _FIRST_ROOM), np.nan, np.float32)
        self._high = self._low.copy()
        self._parts: list[RowPart] = []
        self._sample_time_s = math.nan

    def add(self, position: int, rows: Array) -> None:
        """Take rows that stand at a place of the file, shape (samples, 1 + channels), time stamps first."""
        rows = rows[np.isfinite(rows[:, 0])]
        if not len(rows):
            return
        self._parts.append(RowPart(position, len(rows), float(rows[0, 0]), float(rows[-1, 0])))
        if len(rows) > 1 and math.isnan(self._sample_time_s):
            self._sample_time_s = float(np.median(np.diff(rows[:, 0])))
        if self._first is None:
            self._first = self._numbers(rows[:1, 0]).item()
        numbers = self._room_for(rows[:, 0])
        starts = np.flatnonzero(np.diff(numbers, prepend=numbers[0] - 1))
        with np.errstate(all="ignore"):
            low = np.fmin.reduceat(rows[:, 1:], starts).astype(np.float32)
            high = np.fmax.reduceat(rows[:, 1:], starts).astype(np.float32)
        np.fmin.at(self._low.T, numbers[starts], low)
        np.fmax.at(self._high.T, numbers[starts], high)
        self._count = max(self._count, int(numbers.max()) + 1)

    def envelope(self) -> Envelope | None:
        """What came until now, not copied; None before the first sample."""
        if self._first is None:
            return None
        return Envelope(
            self._names,
            self._width_s,
            self._first,
            self._low[:, : self._count],
            self._high[:, : self._count],
            list(self._parts),
            self._parts[0].first_s,
            self._parts[-1].last_s,
            self._sample_time_s,
        )

    def _numbers(self, times_s: Array) -> npt.NDArray[np.int64]:
        return np.floor(times_s / self._width_s + 1e-6).astype(np.int64)

    def _room_for(self, times_s: Array) -> npt.NDArray[np.int64]:
        """Places of the buckets of these times, for which there is room afterwards."""
        assert self._first is not None
        while True:
            places = np.maximum(self._numbers(times_s) - self._first, 0)
            if places.max() < MOST_BUCKETS:
                break
            self._join()
        while places.max() >= self._low.shape[1]:
            room = np.full_like(self._low, np.nan)
            self._low, self._high = np.hstack([self._low, room]), np.hstack([self._high, room])
        return places

    def _join(self) -> None:
        """Make two buckets one."""
        assert self._first is not None
        lead = self._first % 2
        beside = (lead, (self._count + lead) % 2)
        self._low = _joined(self._low[:, : self._count], 2, beside, np.fmin)
        self._high = _joined(self._high[:, : self._count], 2, beside, np.fmax)
        self._first, self._width_s, self._count = self._first // 2, 2 * self._width_s, self._low.shape[1]


def _power_of_two(least: float) -> int:
    """The smallest that is not less."""
    return 1 << max(0, math.ceil(math.log2(least))) if least > 1.0 else 1


def _joined(values: Low, together: int, beside: tuple[int, int], join: np.ufunc) -> Low:
    """Shape (channels, buckets) with so many buckets made one; `beside` are missing before and behind."""
    if values.shape[1] == 0:
        return np.zeros((len(values), 0), np.float32)
    padded = np.pad(values, ((0, 0), beside), constant_values=np.nan)
    found: Low = join.reduce(padded.reshape(len(values), -1, together), axis=2)
    return found
