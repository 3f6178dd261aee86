"""A recording in memory: channels over time, what was stored with them, and how far its wheel turned."""

from __future__ import annotations

import bisect
from collections.abc import Collection, Iterator, MutableMapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from hil.core.channels import TIME, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.recording._stored import MOST_HELD_BYTES, Places, StoredColumns

Array = npt.NDArray[np.float64]

#: Samples that are looked at together where a recording is gone through from end to end.
BLOCK = 1 << 18


#: Of a table that is read whole: doubles of 2 GB, and more columns than any bench has channels.
LARGEST_VALUES, MOST_COLUMNS = 250_000_000, 10_000


def refuse_too_large(rows: int, columns: int, where: str) -> None:
    """Refuse a table that would not fit into memory, before it is read.

    Raises:
        BadInputError: it has too many columns, or too many values.
    """
    if columns > MOST_COLUMNS:
        raise BadInputError(
            f"has {columns} columns, at most {MOST_COLUMNS} are read",
            where=where,
            fix="omit columns that are not channels",
        )
    if rows * columns > LARGEST_VALUES:
        raise BadInputError(
            f"has {rows} rows of {columns} columns, {8e-9 * rows * columns:.3g} GB as numbers: at most "
            f"{8e-9 * LARGEST_VALUES:g} GB are read at once",
            where=where,
            fix="cut it into pieces; MCAP alone is read piece by piece",
        )


@dataclass
class Event:
    """Something that happened during a run."""

    time_s: float
    kind: str
    text: str


@dataclass
class Recording:
    """Channels over `time_s`, all of one length.

    Of a long MCAP file `channels` stay in it (`StoredColumns`): one that is asked for by name is read whole;
    `rows`, `between` and `blocks` read what they give and no more.

    `attachments` are files stored with the data (plan, bench, controllers, model, run.json);
    `metadata` are named tables of text (versions, hashes, who and what);
    `notes` tell what reading mended or remarked (interpolated cells, columns left out);
    `damage` tells what was lost or cannot be trusted, one sentence each: empty means that everything
    that can be checked was checked and is as it was written.
    `blank_lines` are the samples of a CSV before which a blank line stands, for messages to name lines.
    `mended` are the samples (from 0, rising) of each channel whose cells were missing and are interpolated.
    """

    channels: MutableMapping[str, Array]
    source: Path
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    events: list[Event] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    damage: list[str] = field(default_factory=list)
    blank_lines: list[int] = field(default_factory=list)
    mended: dict[str, Places] = field(default_factory=dict)
    _spacing: tuple[Array, float] | None = field(default=None, init=False, repr=False, compare=False)

    def __getitem__(self, name: str) -> Array:
        """The channel `name`; BadInputError names it when the recording has none."""
        if name not in self.channels:
            self._refuse(name)
        return self.channels[name]

    def _refuse(self, name: str) -> NoReturn:
        raise BadInputError(
            f"has no channel '{name}'",
            where=str(self.source),
            fix=f"it has: {', '.join(self.channels)}; state which it is: --columns '{name}=COLUMN, unit=…'"
            if self.channels
            else "it has: none",
        )

    def __contains__(self, name: object) -> bool:
        return name in self.channels

    @property
    def time_s(self) -> Array:
        """Time stamps in seconds, increasing."""
        return self[TIME]

    @property
    def sample_time_s(self) -> float:
        """Median distance of time stamps in seconds; where channels stay in their file, of block medians."""
        if isinstance(self.channels, StoredColumns):
            return self.channels.sample_time_s
        time_s = self.time_s
        if self._spacing is None or self._spacing[0] is not time_s:  # asked for by every metric
            self._spacing = time_s, float(np.median(np.diff(time_s)))
        return self._spacing[1]

    @property
    def samples(self) -> int:
        """How many there are of each channel."""
        if isinstance(self.channels, StoredColumns):
            return self.channels.samples
        return len(next(iter(self.channels.values()), ()))

    @property
    def first_s(self) -> float:
        """The first time stamp; there must be one."""
        return self.time_at(0)

    @property
    def last_s(self) -> float:
        """The last time stamp; there must be one."""
        return self.time_at(self.samples - 1)

    def time_at(self, sample: int) -> float:
        """Time stamp of a sample, from 0."""
        return float(self.rows(sample, sample + 1, (TIME,))[TIME][0])

    @property
    def samples_sha256(self) -> str:
        """SHA-256 of the samples as they were recorded, '' if no one wrote it down."""
        return self.metadata.get("channels", {}).get("sha256", "")

    def rows(self, first: int, last: int, names: Collection[str] | None = None) -> dict[str, Array]:
        """Samples `first` to `last`, the last left out, of the channels `names`, or of all.

        Raises:
            BadInputError: there is no such channel.
        """
        names = tuple(self.channels) if names is None else names
        for name in names:
            if name not in self:
                self._refuse(name)
        if isinstance(self.channels, StoredColumns):
            return self.channels.rows(first, last, names)
        return {name: self.channels[name][first:last] for name in names}

    def rows_before(self, time_s: float, *, or_at: bool = False) -> int:
        """How many samples lie before a time, or before and at it."""
        if isinstance(self.channels, StoredColumns):
            return self.channels.rows_before(time_s, or_at=or_at)
        return int(np.searchsorted(self.time_s, time_s, "right" if or_at else "left"))

    def blocks(
        self, names: Collection[str] | None = None, at_once: int | None = None
    ) -> Iterator[tuple[int, dict[str, Array]]]:
        """All samples of some channels or of all, block by block, each with its first one's number."""
        at_once = at_once or BLOCK
        for first in range(0, self.samples, at_once):
            yield first, self.rows(first, first + at_once, names)

    def columns(self, names: Collection[str]) -> Iterator[tuple[str, Array]]:
        """Whole channels, one after the other; read together as many as may be held, at least one."""
        together = max(1, MOST_HELD_BYTES // max(1, self.samples * np.float64().nbytes))
        asked = list(names)
        for first in range(0, len(asked), together):
            rows = self.rows(0, self.samples, asked[first : first + together])
            while rows:
                name = next(iter(rows))
                yield name, rows.pop(name)

    def between(self, start_s: float, end_s: float) -> Recording:
        """The samples with start_s <= time_s <= end_s (half a sample of grace on both ends)."""
        grace = 0.5 * self.sample_time_s
        if isinstance(self.channels, StoredColumns):
            return self.piece(self.rows_before(start_s - grace), self.rows_before(end_s + grace, or_at=True))
        inside = (self.time_s >= start_s - grace) & (self.time_s <= end_s + grace)
        return self._with({name: values[inside] for name, values in self.channels.items()})

    def piece(self, first: int, last: int) -> Recording:
        """Samples `first` to `last`, the last left out; where they are many they stay in their file too."""
        if isinstance(self.channels, StoredColumns):
            part = self._with(self.channels.window(first, last))
        else:
            part = self._with(self.rows(first, last))
        part.mended = {c: at[(at >= first) & (at < last)] - first for c, at in self.mended.items()}
        return part

    def without(self, names: Collection[str]) -> Recording:
        """The same without some channels."""
        channels = self.channels.copy() if isinstance(self.channels, StoredColumns) else dict(self.channels)
        for name in names:
            del channels[name]
        return self._with(channels)

    def _with(self, channels: MutableMapping[str, Array]) -> Recording:
        return replace(
            self, channels=channels, notes=list(self.notes), damage=list(self.damage), blank_lines=[]
        )

    def place(self, sample: int) -> str:
        """Where a sample (from 0) stands, for a message: `file: sample 3`, of a CSV also its line."""
        if self.source.suffix.lower() != ".csv":
            return f"{self.source}: sample {sample + 1}"
        line = sample + 2 + bisect.bisect_right(self.blank_lines, sample)
        return f"{self.source}: sample {sample + 1}, line {line}"


_SPEED = "wheel_speed_rad_s"


def with_wheel_angle(recording: Recording, spans_s: Sequence[tuple[float, float]]) -> list[Recording]:
    """Stretches of a recording, each with the wheel's angle in rad since the recording's start."""
    parts = [recording.between(*span_s) for span_s in spans_s]
    firsts = [recording.rows_before(part.first_s) if part.samples else 0 for part in parts]
    for part, angle in zip(parts, _angles_at(recording, firsts), strict=True):
        rows = part.rows(0, part.samples, (TIME, _SPEED))
        part.channels[WHEEL_ANGLE] = _turned(rows[TIME], rows[_SPEED], angle)[: part.samples]
    return parts


def _angles_at(recording: Recording, samples: Sequence[int]) -> list[float]:
    """Angles at samples by number, each block's sum started with that of the blocks before it."""
    angles = dict.fromkeys(samples, 0.0)
    last_s, last, angle = np.zeros(0), np.zeros(0), 0.0
    for first, rows in recording.blocks((TIME, _SPEED)):
        time, speed = np.concatenate([last_s, rows[TIME]]), np.concatenate([last, rows[_SPEED]])
        turned = _turned(time, speed, angle)[len(last) :]
        angles |= {
            number: float(turned[number - first]) for number in angles if 0 <= number - first < len(turned)
        }
        last_s, last, angle = time[-1:], speed[-1:], float(turned[-1])
    return [angles[number] for number in samples]


def _turned(time: Array, speed: Array, begin: float) -> Array:
    """The speed's integral by the trapezoidal rule; one that is not known turns nothing."""
    speed = np.nan_to_num(speed)
    steps = 0.5 * np.diff(time) * (speed[1:] + speed[:-1])
    return np.asarray(np.cumsum(np.concatenate([[begin], steps])))
