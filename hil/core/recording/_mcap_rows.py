"""Rows of samples of an MCAP file: held as long as they are few, then found again in the file."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from hil.core.errors import BadInputError
from hil.core.files import open_regular
from hil.core.recording import _mcap_records as mcap
from hil.core.recording import _schema, _stored
from hil.core.recording._mcap_walk import raw_record, records_inside
from hil.core.recording._stored import Array, Part, StoredColumns


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
        if self._held_bytes > _stored.MOST_HELD_BYTES:
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
