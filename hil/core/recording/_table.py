"""A recording in memory: channels over time, and what was stored with them."""

from __future__ import annotations

import bisect
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.channels import CHANNELS, INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError

Array = npt.NDArray[np.float64]

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

    `attachments` are files stored with the data (plan, bench, controllers, model, run.json);
    `metadata` are named tables of text (versions, hashes, who and what);
    `notes` tell what reading mended or remarked (interpolated cells, columns left out);
    `damage` tells what was lost or cannot be trusted, one sentence each: empty means that everything
    that can be checked was checked and is as it was written.
    `blank_lines` are the samples of a CSV before which a blank line stands, for messages to name lines.
    """

    channels: dict[str, Array]
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
        try:
            return self.channels[name]
        except KeyError:
            raise BadInputError(
                f"has no channel '{name}'",
                where=str(self.source),
                fix=f"it has: {', '.join(self.channels) or 'none'}",
            ) from None

    def __contains__(self, name: object) -> bool:
        return name in self.channels

    @property
    def time_s(self) -> Array:
        """Time stamps in seconds, increasing."""
        return self[TIME]

    @property
    def sample_time_s(self) -> float:
        """Median distance of time stamps in seconds."""
        time_s = self.time_s
        if self._spacing is None or self._spacing[0] is not time_s:  # asked for by every metric
            self._spacing = time_s, float(np.median(np.diff(time_s)))
        return self._spacing[1]

    @property
    def samples_sha256(self) -> str:
        """SHA-256 of the samples as they were recorded, '' if nobody wrote it down."""
        return self.metadata.get("channels", {}).get("sha256", "")

    def between(self, start_s: float, end_s: float) -> Recording:
        """The samples with start_s <= time_s <= end_s (half a sample of grace on both ends)."""
        grace = 0.5 * self.sample_time_s
        inside = (self.time_s >= start_s - grace) & (self.time_s <= end_s + grace)
        cut = {name: values[inside] for name, values in self.channels.items()}
        return replace(self, channels=cut, notes=list(self.notes), damage=list(self.damage), blank_lines=[])

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
        recording[name]
    if not any_channels and not any(name in recording for name in OUTPUTS):
        raise BadInputError(
            f"has none of the output channels {', '.join(OUTPUTS)}", where=where, fix="record at least one"
        )
    time = recording.time_s
    if len(time) < least_samples:
        raise BadInputError(f"has {len(time)} samples, {least_samples} are needed", where=where)
    if not np.all(np.isfinite(time)):
        row = int(np.flatnonzero(~np.isfinite(time))[0])
        raise BadInputError(f"'{TIME}' is not finite", where=recording.place(row))
    _refuse_huge(recording)
    backwards = np.flatnonzero(np.diff(time) <= 0)
    if backwards.size:
        row = int(backwards[0]) + 1
        raise BadInputError(
            f"'{TIME}' does not increase: {time[row]:g} s follows {time[row - 1]:g} s",
            where=recording.place(row),
        )
    for name in (INPUT, *OUTPUTS):
        if name in recording:
            _mend(recording, name, allow_missing=allow_missing)
    return recording


def _refuse_huge(recording: Recording) -> None:
    for name in recording.channels.keys() & CHANNELS.keys():
        values = recording[name]
        huge = np.isfinite(values) & ((values > LARGEST_MAGNITUDE) | (values < -LARGEST_MAGNITUDE))
        if huge.any():
            row = int(huge.argmax())
            raise BadInputError(
                f"{values[row]:g} is no measurement: at most {LARGEST_MAGNITUDE:g} can be used",
                where=f"{recording.place(row)}, column '{name}'",
                fix="correct the cell, or leave it empty",
            )


def _mend(recording: Recording, name: str, *, allow_missing: bool) -> None:
    values = recording[name]
    missing = ~np.isfinite(values)
    if not missing.any():
        return
    share = float(np.mean(missing))
    if share > LARGEST_MISSING_SHARE and allow_missing:
        recording.notes.append(f"{share:.1%} of '{name}' is missing")
        return
    if share > LARGEST_MISSING_SHARE:
        row = int(np.flatnonzero(missing)[0])
        raise BadInputError(
            f"{share:.1%} of '{name}' is NaN or infinite, {LARGEST_MISSING_SHARE:.0%} is allowed",
            where=f"first at {recording.place(row)}",
        )
    time = recording.time_s
    recording.channels[name] = np.interp(time, time[~missing], values[~missing])
    recording.notes.append(f"{int(missing.sum())} missing cells of '{name}' were interpolated")
