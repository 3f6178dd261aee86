"""A recording in memory: channels over time, and what was stored with them."""

from __future__ import annotations

import bisect
from collections.abc import Collection, Iterator, MutableMapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from hil.core.channels import CHANNELS, INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.recording._stored import Places, StoredColumns

Array = npt.NDArray[np.float64]

#: Samples that are looked at together where a recording is gone through from end to end.
BLOCK = 1 << 18

#: Largest share of NaN or infinite cells in a required channel.
LARGEST_MISSING_SHARE = 0.01

#: Largest magnitude that a channel of the contract may have, in its unit: beyond it no axle can be, and
#: products of a few such numbers still fit a double.
LARGEST_MAGNITUDE = 1e15


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
    """

    channels: MutableMapping[str, Array]
    source: Path
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    events: list[Event] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    damage: list[str] = field(default_factory=list)
    blank_lines: list[int] = field(default_factory=list)
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
            fix=f"it has: {', '.join(self.channels) or 'none'}",
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
        return len(self.channels.get(TIME, ()))

    @property
    def first_s(self) -> float:
        """The first time stamp; there must be one."""
        return float(self.rows(0, 1, (TIME,))[TIME][0])

    @property
    def last_s(self) -> float:
        """The last time stamp; there must be one."""
        return float(self.rows(self.samples - 1, self.samples, (TIME,))[TIME][0])

    @property
    def samples_sha256(self) -> str:
        """SHA-256 of the samples as they were recorded, '' if nobody wrote it down."""
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
        self, names: Collection[str] | None = None, at_once: int = BLOCK
    ) -> Iterator[tuple[int, dict[str, Array]]]:
        """All samples of some channels or of all, so many at once, each block with its first one's number."""
        for first in range(0, self.samples, at_once):
            yield first, self.rows(first, first + at_once, names)

    def between(self, start_s: float, end_s: float) -> Recording:
        """The samples with start_s <= time_s <= end_s (half a sample of grace on both ends)."""
        grace = 0.5 * self.sample_time_s
        channels: MutableMapping[str, Array]
        if isinstance(self.channels, StoredColumns):
            first, last = self.rows_before(start_s - grace), self.rows_before(end_s + grace, or_at=True)
            channels = self.channels.window(first, last)
        else:
            inside = (self.time_s >= start_s - grace) & (self.time_s <= end_s + grace)
            channels = {name: values[inside] for name, values in self.channels.items()}
        return self._with(channels)

    def piece(self, first: int, last: int) -> Recording:
        """Samples `first` to `last`, the last left out."""
        return self._with(self.rows(first, last))

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


def checked(
    recording: Recording,
    *,
    least_samples: int = 2,
    allow_missing: bool = False,
    any_channels: bool = False,
) -> Recording:
    """Refuse what no command can use; mend small gaps in cells and say so in `notes`.

    With `allow_missing`, channels with many missing cells stay as they are (a report of a failed run); with
    `any_channels` the axle's need not be there.

    Raises:
        BadInputError: a required channel is missing, time runs backwards or stands still, too many
            missing cells, values beyond LARGEST_MAGNITUDE, or too few samples.
    """
    where = str(recording.source)
    for name in (TIME,) if any_channels else (TIME, INPUT):
        if name not in recording:
            recording[name]
    if not any_channels and not any(name in recording for name in OUTPUTS):
        raise BadInputError(
            f"has none of the output channels {', '.join(OUTPUTS)}", where=where, fix="record at least one"
        )
    if recording.samples < least_samples:
        raise BadInputError(f"has {recording.samples} samples, {least_samples} are needed", where=where)
    known = [name for name in CHANNELS if name in recording]
    lacking = {name: _Lacking() for name in (INPUT, *OUTPUTS) if name in recording}
    before_s = -np.inf
    for first, block in recording.blocks(known):
        time = block[TIME]
        if not np.all(np.isfinite(time)):
            row = first + int(np.flatnonzero(~np.isfinite(time))[0])
            raise BadInputError(f"'{TIME}' is not finite", where=recording.place(row))
        _refuse_huge(recording, first, block)
        _refuse_backwards(recording, first, time, before_s)
        before_s = float(time[-1])
        for name, cells in lacking.items():
            cells.count(first, block[name])
    for name, cells in lacking.items():
        _mend(recording, name, cells, allow_missing=allow_missing)
    return recording


@dataclass
class _Lacking:
    """Cells of a channel that are missing: how many, and the number of the first."""

    missing: int = 0
    first: int = 0

    def count(self, first: int, values: Array) -> None:
        missing = ~np.isfinite(values)
        if not missing.any():
            return
        if not self.missing:
            self.first = first + int(missing.argmax())
        self.missing += int(missing.sum())


def _refuse_backwards(recording: Recording, first: int, time: Array, before_s: float) -> None:
    """`before_s`: of the sample before the first one of `time`."""
    time = np.concatenate([[before_s], time])
    backwards = np.flatnonzero(np.diff(time) <= 0)
    if backwards.size:
        row = int(backwards[0])
        raise BadInputError(
            f"'{TIME}' does not increase: {time[row + 1]:g} s follows {time[row]:g} s",
            where=recording.place(first + row),
        )


def _refuse_huge(recording: Recording, first: int, block: dict[str, Array]) -> None:
    for name, values in block.items():
        huge = np.isfinite(values) & ((values > LARGEST_MAGNITUDE) | (values < -LARGEST_MAGNITUDE))
        if huge.any():
            row = int(huge.argmax())
            raise BadInputError(
                f"{values[row]:g} is no measurement: at most {LARGEST_MAGNITUDE:g} can be used",
                where=f"{recording.place(first + row)}, column '{name}'",
                fix="correct the cell, or leave it empty",
            )


def _mend(recording: Recording, name: str, lacking: _Lacking, *, allow_missing: bool) -> None:
    if not lacking.missing:
        return
    share = lacking.missing / recording.samples
    if share > LARGEST_MISSING_SHARE and allow_missing:
        recording.notes.append(f"{share:.1%} of '{name}' is missing")
        return
    if share > LARGEST_MISSING_SHARE:
        raise BadInputError(
            f"{share:.1%} of '{name}' is NaN or infinite, {LARGEST_MISSING_SHARE:.0%} is allowed",
            where=f"first at {recording.place(lacking.first)}",
        )
    places, cells = _interpolated(recording, name)
    if isinstance(recording.channels, StoredColumns):
        recording.channels.mend(name, places, cells)
    else:
        values = recording[name].copy()
        values[places] = cells
        recording.channels[name] = values
    recording.notes.append(f"{lacking.missing} missing cells of '{name}' were interpolated")


def _interpolated(recording: Recording, name: str) -> tuple[Places, Array]:
    """Numbers of the missing samples, and what a straight line between their neighbours gives there."""
    places, missing_s, beside_s, beside = [], [], [], []
    for first, block in recording.blocks((TIME, name)):
        time, values = block[TIME], block[name]
        there = np.isfinite(values)
        places.append(first + np.flatnonzero(~there))
        missing_s.append(time[~there])
        within = np.append(there[1:], False) & np.append(False, there[:-1])
        kept = there & ~within  # next to a gap, or at an end of the block
        beside_s.append(time[kept])
        beside.append(values[kept])
    cells = np.interp(np.concatenate(missing_s), np.concatenate(beside_s), np.concatenate(beside))
    return np.concatenate(places), cells
