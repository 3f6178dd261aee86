"""What no command could use of a recording is refused; small gaps in cells are mended."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hil.core.channels import ANY_OUTPUT, CHANNELS, INPUT, TIME
from hil.core.errors import BadInputError
from hil.core.recording._stored import Places, StoredColumns
from hil.core.recording._table import Array, Recording

#: Largest share of NaN or infinite cells in a required channel.
LARGEST_MISSING_SHARE = 0.01

#: Largest magnitude that a channel of the contract may have, in its unit: beyond it no axle can be, and
#: products of a few such numbers still fit a double.
LARGEST_MAGNITUDE = 1e15


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
    if not any_channels and not any(name in recording for name in ANY_OUTPUT):
        raise BadInputError(
            f"has none of the output channels {', '.join(ANY_OUTPUT)}", where=where, fix="record at least one"
        )
    if recording.samples < least_samples:
        raise BadInputError(f"has {recording.samples} samples, {least_samples} are needed", where=where)
    known = [name for name in CHANNELS if name in recording]
    lacking = {name: _Lacking() for name in (INPUT, *ANY_OUTPUT) if name in recording}
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
            fix="sort the samples by time, or cut the recording there",
        )


def _refuse_huge(recording: Recording, first: int, block: dict[str, Array]) -> None:
    for name, values in block.items():
        huge = np.isfinite(values) & ((values > LARGEST_MAGNITUDE) | (values < -LARGEST_MAGNITUDE))
        if huge.any():
            row = int(huge.argmax())
            raise BadInputError(
                f"{values[row]:g} is not a plausible measurement: at most {LARGEST_MAGNITUDE:g} can be used",
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
            fix="cut out what was not measured, or leave the channel out",
        )
    places, cells = _interpolated(recording, name)
    if isinstance(recording.channels, StoredColumns):
        recording.channels.mend(name, places, cells)
    else:
        values = recording[name].copy()
        values[places] = cells
        recording.channels[name] = values
    recording.mended[name] = places
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
