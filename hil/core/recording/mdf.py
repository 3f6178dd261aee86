"""ASAM MDF4 with asammdf: channels in groups, each group with time stamps of its own."""

from __future__ import annotations

import contextlib
import datetime
import io
import logging
import warnings
from collections.abc import Collection
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from hil.core.channels import CHANNELS, INPUT, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.files import refuse_unless_regular, replacing
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._evidence import EVIDENCE, evidence_of, has_evidence, take_evidence
from hil.core.recording._foreign_table import Column, recording_of
from hil.core.recording._table import BLOCK, Array, Recording, refuse_too_large


def open_mdf(path: Path) -> Any:
    """asammdf's MDF of a file, to be closed by a `with`.

    Raises:
        Exception: of many kinds, for whatever is broken.
    """
    from asammdf import MDF  # slow to import, and seldom needed
    from asammdf.blocks.mdf_v4 import MDF4

    # What it finds odd in a file it also prints, with a traceback; what matters of it is stated here.
    logging.getLogger("asammdf").setLevel(logging.CRITICAL + 1)
    MDF4.__del__ = _close
    try:
        return MDF(path)
    except Exception as error:
        _close_files(error.__traceback__)
        raise


def _close_files(trace: TracebackType | None) -> None:
    """Close what asammdf opened before it found a file broken: it leaves that to the garbage collector."""
    while trace is not None:
        for held in list(trace.tb_frame.f_locals.values()):
            for one in (held, getattr(held, "_file", None)):
                if isinstance(one, io.BufferedReader):
                    one.close()
        trace = trace.tb_next


def _close(mdf: Any) -> None:
    """Close what a broken file kept from being set up: asammdf's own way prints a traceback then."""
    with contextlib.suppress(AttributeError):
        mdf.close()


_EVENT_TICKS = 1_000_000  # in a second
_BEGINS = (b"MDF", b"UnFinMF")  # finished, and not
_MASTERS = (2, 3)  # channel types of the standard: time stamps, stored or counted


def read_mdf(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """Read MDF4; channels of other groups are put on the time stamps of the input's group.

    Raises:
        BadInputError: no MDF file or a broken one, or a known channel that is no column of numbers.
    """
    refuse_unless_regular(path)
    _refuse_other(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with open_mdf(path) as mdf:
                recording = _Groups(mdf, path, columns).read()
                for index, attachment in enumerate(mdf.attachments):
                    if attachment.file_name == EVIDENCE:
                        content = mdf.extract_attachment(index)[0]
                        take_evidence(recording, content, f"the attachment '{EVIDENCE}'")
                return recording
    except BadInputError:
        raise
    except Exception as error:  # of many kinds, for whatever is broken
        raise BadInputError("not an MDF file, or a broken one", where=str(path)) from error


def _refuse_other(path: Path) -> None:
    """Refuse what does not begin as MDF: asammdf would leave it open."""
    with path.open("rb") as file:
        if not file.read(8).startswith(_BEGINS):
            raise BadInputError("not an MDF file, or a broken one", where=str(path))


class _Groups:
    """The channels of an open MDF file; those of other groups come to the stamps of the input's."""

    def __init__(self, mdf: Any, path: Path, columns: ColumnMap) -> None:
        self._mdf, self._path, self._map = mdf, path, columns
        self._notes: list[str] = []
        self._places: dict[str, tuple[int, int]] = {}
        wanted = {source.column for _, source in columns.columns()}
        for group, content in enumerate(mdf.groups):
            for index, channel in enumerate(content.channels):
                if channel.channel_type not in _MASTERS:
                    self._place(str(channel.name), group, index, wanted)
        rows = max((content.channel_group.cycles_nr for content in mdf.groups), default=0)
        refuse_too_large(rows, len(self._places) + 1, str(path))  # and the time

    def _place(self, name: str, group: int, index: int, wanted: Collection[str]) -> None:
        if name not in self._places:
            self._places[name] = (group, index)
        elif name in CHANNELS or name in wanted:
            raise BadInputError(f"channel '{name}' stands twice", where=str(self._path))
        else:
            self._notes.append(f"channel '{name}' stands twice; the first was taken")

    def read(self) -> Recording:
        masters: dict[int, Array] = {}
        table: dict[str, Column] = {}
        base = self._base()
        for name, (group, index) in self._places.items():
            if name == TIME and group != base:
                continue
            if group not in masters:
                masters[group] = np.asarray(self._mdf.get_master(group), np.float64)
            column = self._column(name, group, index, masters[group])
            if column is not None:
                table[name] = column
        own = any(attachment.file_name == EVIDENCE for attachment in self._mdf.attachments)
        return recording_of(table, self._path, self._map, "channel", self._notes, own=own)

    def _base(self) -> int:
        """The group whose stamps are the recording's."""
        input_column = self._map.sources[INPUT].column if INPUT in self._map.sources else INPUT
        return self._places.get(input_column, next(iter(self._places.values()), (0, 0)))[0]

    def _column(self, name: str, group: int, index: int, time_s: Array) -> Column | None:
        signal = self._mdf.get(group=group, index=index)
        if signal.samples.ndim != 1 or signal.samples.dtype.kind not in "iufb":
            if name in CHANNELS:
                raise BadInputError("is not numeric", where=f"{self._path}: channel '{name}'")
            self._notes.append(f"channel '{name}' is not numeric and was left out")
            return None
        values: Array = signal.samples.astype(np.float64)
        if signal.invalidation_bits is not None:
            values[np.asarray(signal.invalidation_bits, bool)] = np.nan
        return Column(values, str(signal.unit or ""), None if name == TIME else time_s)


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
