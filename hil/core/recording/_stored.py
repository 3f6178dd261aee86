"""Channels that stay in their file, and rows of MCAP samples: held while few, else found again there."""

from __future__ import annotations

import bisect
import copy
import os
from collections.abc import Collection, Iterator, MutableMapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.files import open_regular
from hil.core.recording import _mcap_records as mcap
from hil.core.recording import _schema
from hil.core.recording._mcap_walk import raw_record, records_inside

Array = npt.NDArray[np.float64]
Places = npt.NDArray[np.intp]

#: Rows of more than so much are not held: eight minutes of a bench with sixteen channels.
MOST_HELD_BYTES = 1 << 26


@dataclass(frozen=True)
class Part:
    """Some rows that stand together in the file at `position`: the first one's number and time in s."""

    position: int
    first: int
    first_s: float


class PartReader(Protocol):
    """Reads the rows of a part, shape (samples, channels)."""

    def __call__(self, position: int, count: int) -> Array:
        """All of them.

        Raises:
            BadInputError: the file is not what it was.
        """
        ...


class StoredColumns(MutableMapping[str, Array]):
    """Channels by name, each read whole from the file when it is asked for.

    Args:
        names: of the columns of the file's rows, time stamps first.
        parts: in the order of the file, each not empty.
        samples: how many rows there are.
        sample_time_s: the median of the parts' median distances of time stamps.
    """

    def __init__(
        self, names: list[str], parts: list[Part], samples: int, sample_time_s: float, read: PartReader
    ) -> None:
        self.samples = self._in_file = samples
        self.sample_time_s = sample_time_s
        self._begin = 0  # number in the file of the first sample here
        self._columns = {name: column for column, name in enumerate(names)}
        self._parts = parts
        self._read = read
        self._held: dict[str, Array] = {}
        self._cells: dict[str, tuple[Places, Array]] = {}

    def __getitem__(self, name: str) -> Array:
        if name not in self:
            raise KeyError(name)
        return self.rows(0, self.samples, [name])[name]

    def __setitem__(self, name: str, values: Array) -> None:
        self._held[name] = values

    def __delitem__(self, name: str) -> None:
        if name not in self:
            raise KeyError(name)
        self._held.pop(name, None)
        self._columns.pop(name, None)

    def __iter__(self) -> Iterator[str]:
        return iter({**self._columns, **self._held})

    def __len__(self) -> int:
        return len(self._columns.keys() | self._held.keys())

    def __contains__(self, name: object) -> bool:  # the mixin's would read the channel
        return name in self._columns or name in self._held

    def rows(self, first: int, last: int, names: Collection[str]) -> dict[str, Array]:
        """Samples `first` to `last`, the last left out, of some channels; each array is the caller's own."""
        first, last = max(0, first), min(last, self.samples)
        count = max(0, last - first)
        found = {name: np.empty(count) for name in names}
        asked = [(self._columns[name], found[name]) for name in names if name not in self._held]
        begin, end = self._begin + first, self._begin + last
        if asked and count:
            self._fill(begin, end, asked)
        for name, values in found.items():
            if name in self._held:
                values[:] = self._held[name][first:last]
            elif name in self._cells:
                places, cells = self._cells[name]
                inside = slice(*np.searchsorted(places, (begin, end)).tolist())
                values[places[inside] - begin] = cells[inside]
        return found

    def rows_before(self, time_s: float, *, or_at: bool = False) -> int:
        """How many samples lie before a time, or before and at it; time stamps increase."""
        search = bisect.bisect_right if or_at else bisect.bisect_left
        number = search(self._parts, time_s, key=lambda part: part.first_s) - 1
        if number < 0:
            return 0
        time = self._part(number)[:, 0]
        inside = int(np.searchsorted(time, time_s, "right" if or_at else "left"))
        return min(max(0, self._parts[number].first + inside - self._begin), self.samples)

    def window(self, first: int, last: int) -> dict[str, Array] | StoredColumns:
        """Samples `first` to `last`, the last left out: read, or where they are many left in the file."""
        first, last = max(0, first), min(last, self.samples)
        count = max(0, last - first)
        if count * len(self) * np.float64().nbytes <= MOST_HELD_BYTES:
            return self.rows(first, last, tuple(self))
        part = self.copy()
        part._begin, part.samples = self._begin + first, count
        part._held = {name: values[first:last] for name, values in self._held.items()}
        return part

    def copy(self) -> StoredColumns:
        """Another of the same file, to add channels to or to take some from."""
        other = copy.copy(self)
        other._columns, other._cells, other._held = dict(self._columns), dict(self._cells), dict(self._held)
        return other

    def mend(self, name: str, places: Places, cells: Array) -> None:
        """Put other values in the place of some samples, in increasing order."""
        self._cells[name] = (self._begin + places, cells)

    def _fill(self, first: int, last: int, asked: list[tuple[int, Array]]) -> None:
        begin = bisect.bisect_right(self._parts, first, key=lambda part: part.first) - 1
        for number in range(begin, len(self._parts)):
            at = self._parts[number].first
            if at >= last:
                return
            rows = self._part(number)
            rows = rows[max(0, first - at) : last - at]
            to = max(at, first) - first
            for column, values in asked:
                values[to : to + len(rows)] = rows[:, column]

    def _part(self, number: int) -> Array:
        part = self._parts[number]
        following = self._parts[number + 1].first if number + 1 < len(self._parts) else self._in_file
        return self._read(part.position, following - part.first)


class Times(Protocol):
    """Time stamps in s, by number."""

    def __len__(self) -> int: ...

    def __getitem__(self, row: int) -> float: ...


class Rows:
    """Takes the rows of a file as they are read, in its order."""

    def __init__(self) -> None:
        self.count = 0
        self._held: list[Array] | None = []  # None: too many
        self._held_bytes = 0
        self._parts: list[Part] = []
        self._distances: list[float] = []

    def add(self, position: int, rows: Array) -> None:
        """Add rows of the record at `position`, shape (samples, channels), time stamps first."""
        if not len(rows):
            return
        if not self._parts or self._parts[-1].position != position:
            self._parts.append(Part(position, self.count, float(rows[0, 0])))
        if len(rows) > 1:
            self._distances.append(float(np.median(np.diff(rows[:, 0]))))
        self.count += len(rows)
        self._held_bytes += rows.nbytes
        if self._held_bytes > MOST_HELD_BYTES:
            self._held = None
        if self._held is not None:
            self._held.append(rows)

    def times(self, path: Path, names: list[str], ids: Collection[int]) -> tuple[Times, float]:
        """Time stamps, and the median of their distances (NaN: fewer than two)."""
        if self._held is None:
            columns = self._stored(path, names, ids)
            return _StoredTimes(columns, names[0]), columns.sample_time_s
        times = np.concatenate([rows[:, 0] for rows in self._held]) if self._held else np.zeros(0)
        return times, float(np.median(np.diff(times))) if len(times) > 1 else float("nan")

    def channels(
        self, path: Path, names: list[str], ids: Collection[int]
    ) -> dict[str, Array] | StoredColumns:
        """Each channel's samples; what is held is handed over, so that it is not held twice.

        Args:
            ids: of the channels of the file whose messages are rows.
        """
        if self._held is None:
            return self._stored(path, names, ids)
        channels = {name: np.empty(self.count) for name in names}
        end = self.count
        while self._held:
            rows = self._held.pop()
            for column, values in enumerate(channels.values()):
                values[end - len(rows) : end] = rows[:, column]
            end -= len(rows)
        return channels

    def _stored(self, path: Path, names: list[str], ids: Collection[int]) -> StoredColumns:
        distance_s = float(np.median(self._distances)) if self._distances else float("nan")
        return StoredColumns(
            names, self._parts, self.count, distance_s, RowReader(path, names, frozenset(ids))
        )


@dataclass(frozen=True)
class RowReader:
    """Reads the rows of one record of a file again; data, so that other processes can have it."""

    path: Path
    names: list[str]
    ids: frozenset[int]

    def __call__(self, position: int, count: int) -> Array:
        """The `count` rows of the record at `position`.

        Raises:
            BadInputError: there are others now, or the file cannot be read.
        """
        with open_regular(self.path) as file:
            try:
                found = raw_record(file, position, os.fstat(file.fileno()).st_size)
            except OSError as error:
                reason = error.strerror or str(error)
                raise BadInputError(f"cannot be read: {reason}", where=str(self.path)) from error
        record = mcap.parsed(*found) if found else None
        inside = records_inside(record.content) if isinstance(record, mcap.Chunk) else [record]
        payloads = [m.payloads for m in inside if isinstance(m, mcap.Messages) and m.channel_id in self.ids]
        rows = _schema.decode_parts(payloads, len(self.names))
        if len(rows) != count:
            raise BadInputError(
                "was changed while it was being read",
                where=str(self.path),
                fix="read it when no one writes it",
            )
        return rows


@dataclass(frozen=True)
class _StoredTimes:
    columns: StoredColumns
    name: str

    def __len__(self) -> int:
        return self.columns.samples

    def __getitem__(self, row: int) -> float:
        at = row % len(self)
        return float(self.columns.rows(at, at + 1, [self.name])[self.name][0])
