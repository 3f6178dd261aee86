"""MDF4 with asammdf: channels in groups, each group with time stamps of its own."""

from __future__ import annotations

import contextlib
import datetime
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from hil.core.channels import CHANNELS, INPUT, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.files import refuse_unless_regular, replacing
from hil.core.recording._evidence import EVIDENCE, evidence_of, has_evidence, take_evidence
from hil.core.recording._table import BLOCK, Array, Recording, refuse_too_large
from hil.core.recording.mdf_file import open_mdf
from hil.core.units import converted

_EVENT_TICKS = 1_000_000  # in a second
_MASTERS = (2, 3)  # channel types of the standard: time stamps, stored or counted


def read_mdf(path: Path) -> Recording:
    """Read MDF4; channels of other groups are put on the time stamps of the input's group.

    Raises:
        BadInputError: no MDF file or a broken one, or a known channel that is no column of numbers.
    """
    refuse_unless_regular(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with open_mdf(path) as mdf:
                recording = _Groups(mdf, path).read()
                for index, attachment in enumerate(mdf.attachments):
                    if attachment.file_name == EVIDENCE:
                        content = mdf.extract_attachment(index)[0]
                        take_evidence(recording, content, f"the attachment '{EVIDENCE}'")
                return recording
    except BadInputError:
        raise
    except Exception as error:  # of many kinds, for whatever is broken
        raise BadInputError("not an MDF file, or a broken one", where=str(path)) from error


class _Groups:
    """The channels of an open MDF file, one at a time so that the table is not held twice."""

    def __init__(self, mdf: Any, path: Path) -> None:
        self._mdf = mdf
        self._path = path
        self._notes: list[str] = []
        self._places: dict[str, tuple[int, int]] = {}
        for group, content in enumerate(mdf.groups):
            for index, channel in enumerate(content.channels):
                if channel.channel_type not in _MASTERS:
                    self._place(str(channel.name), group, index)
        rows = max((content.channel_group.cycles_nr for content in mdf.groups), default=0)
        refuse_too_large(rows, len(self._places) + 1, str(path))  # and the time

    def _place(self, name: str, group: int, index: int) -> None:
        if name not in self._places:
            self._places[name] = (group, index)
        elif name in CHANNELS:
            raise BadInputError(f"channel '{name}' stands twice", where=str(self._path))
        else:
            self._notes.append(f"channel '{name}' stands twice; the first was taken")

    def read(self) -> Recording:
        channels: dict[str, Array] = {}
        if self._places:
            base = self._places.get(INPUT, next(iter(self._places.values())))[0]
            masters = {group: self._master(group) for group in {g for g, _ in self._places.values()}}
            time_s = masters[base]
            if self._places.get(TIME, (-1, 0))[0] != base:
                channels[TIME] = time_s
                self._places.pop(TIME, None)
            for name, (group, index) in self._places.items():
                values = self._values(name, group, index)
                if values is not None and group != base:
                    values = self._moved(name, masters[group], values, time_s)
                if values is not None:
                    channels[name] = values
        return Recording(channels, self._path, notes=self._notes)

    def _master(self, group: int) -> Array:
        return np.asarray(self._mdf.get_master(group), np.float64)

    def _values(self, name: str, group: int, index: int) -> Array | None:
        signal = self._mdf.get(group=group, index=index)
        if signal.samples.ndim != 1 or signal.samples.dtype.kind not in "iufb":
            self._refuse(name, "is not numeric")
            return None
        values: Array = signal.samples.astype(np.float64)
        if signal.invalidation_bits is not None:
            values[np.asarray(signal.invalidation_bits, bool)] = np.nan
        where = f"{self._path}: channel '{name}'"
        return converted(values, name, str(signal.unit or ""), where, self._notes)

    def _moved(self, name: str, own_s: Array, values: Array, time_s: Array) -> Array | None:
        """Values between their own time stamps, NaN outside of them."""
        if np.array_equal(own_s, time_s):
            return values
        if len(own_s) == 0 or np.any(np.diff(own_s) <= 0):
            self._refuse(name, "has time stamps of its own that do not increase")
            return None
        self._notes.append(f"channel '{name}' was interpolated at the time stamps of '{INPUT}'")
        return np.interp(time_s, own_s, values, left=np.nan, right=np.nan)

    def _refuse(self, name: str, why: str) -> None:
        if name in CHANNELS:
            raise BadInputError(why, where=f"{self._path}: channel '{name}'")
        self._notes.append(f"channel '{name}' {why} and was left out")


def write_mdf(recording: Recording, path: Path) -> None:
    """Write MDF 4.10 with units and comments, a stretch at a time so that the samples are not held twice.

    What the recording has beside its samples stands in an attachment; what happened also as the file's
    events, what was run in its header.
    """
    from asammdf import MDF, Signal

    names = [name for name in recording.channels if name != TIME]
    with replacing(path) as temporary, MDF(version="4.10") as mdf:
        first = recording.rows(0, BLOCK)
        signals = [
            Signal(
                samples=first[name],
                timestamps=first[TIME],
                name=name,
                unit=unit_of(name),
                comment=CHANNELS[name].meaning if name in CHANNELS else "",
            )
            for name in names
        ]
        mdf.append(signals, comment="eaxle-hil recording", common_timebase=True)
        for start in range(BLOCK, recording.samples, BLOCK):
            rows = recording.rows(start, start + BLOCK, (TIME, *names))
            mdf.extend(0, [(values, None) for values in rows.values()])
        if has_evidence(recording):
            _tell(mdf, recording)
        mdf.save(temporary, overwrite=True, compression=2)


def _tell(mdf: Any, recording: Recording) -> None:
    """Attachment, header and events of a recording that has more than samples."""
    from asammdf.blocks.v4_blocks import EventBlock

    text = evidence_of(recording).encode()
    mdf.attach(
        text, EVIDENCE, comment="what the recording carries beside its samples", mime="application/json"
    )
    tell_header(mdf, recording, starts_at="row_0_at")
    for event in recording.events:
        block = EventBlock(sync_base=round(event.time_s * _EVENT_TICKS), sync_factor=1.0 / _EVENT_TICKS)
        block.name, block.comment = event.kind, event.text
        mdf.events.append(block)


def tell_header(mdf: Any, recording: Recording, *, starts_at: str) -> None:
    """Who, what and when; `starts_at`: where the table `time` has the moment at which stamps are 0."""
    run, dut = recording.metadata.get("run", {}), recording.metadata.get("dut", {})
    header = mdf.header
    header.project, header.author = run.get("title", ""), run.get("operator", "")
    header.subject = " ".join(filter(None, (dut.get("name"), dut.get("serial"))))
    started = recording.metadata.get("time", {}).get(starts_at) or run.get("started_at", "")
    with contextlib.suppress(ValueError):
        header.start_time = datetime.datetime.fromisoformat(started)
