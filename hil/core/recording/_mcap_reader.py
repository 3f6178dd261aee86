"""Reads an MCAP file back: the native recording, or one whose channels have the names of another tool.

Of a native recording it is known what is whole of it, and what is not.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FrameBlock, empty_block
from hil.core.channels import CHANNELS
from hil.core.errors import BadInputError
from hil.core.files import open_regular
from hil.core.recording import _mcap_records as mcap
from hil.core.recording import _schema
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._evidence import RUN
from hil.core.recording._foreign_table import Column, recording_of
from hil.core.recording._mcap_damage import Findings, damage, lost_earlier
from hil.core.recording._mcap_walk import MAGIC, placed_records, records_inside
from hil.core.recording._mcap_writer import CHANNELS_TOPIC, EVENTS_TOPIC, FRAMES_TOPIC
from hil.core.recording._stored import Rows, StoredColumns
from hil.core.recording._table import Array, Event, Recording

Definitions = tuple[dict[int, mcap.Schema], dict[int, mcap.Channel]]


def read_mcap(path: Path) -> Recording:
    """Channels, events, attachments and metadata of a recording; `damage` tells what is lost.

    Raises:
        BadInputError: not an MCAP file, no channels in it, or no sample that can be read.
    """
    contents = _contents(path)
    channels = contents.channels()
    if not len(contents.findings.sample_times_s) and contents.findings.broken:
        raise BadInputError(
            "the recording is broken: no sample can be read", where=str(path), fix="use another copy"
        )
    return Recording(
        channels,
        path,
        contents.metadata,
        contents.attachments,
        contents.events,
        contents.notes(),
        [*damage(contents.findings), *lost_earlier(contents.metadata)],
    )


def definitions_of(path: Path) -> Definitions:
    """Schemas and channels of a recording by their ids, as `read_mcap` found them."""
    return _contents(path).definitions


def read_frames(path: Path) -> dict[str, FrameBlock]:
    """Raw frames of each bus, as they came; `damage` of `read_recording` tells what is lost of them.

    Raises:
        BadInputError: not an MCAP file, or frames that are not laid out as the project's.
    """
    frames = _contents(path, keep_frames=True).frames
    try:
        return {
            bus: np.concatenate([_schema.decode_frames(m) for m in messages]) if messages else empty_block()
            for bus, messages in frames.items()
        }
    except ValueError as error:
        raise BadInputError(
            f"its raw frames cannot be read: {error}", where=str(path), fix="is it a hil recording?"
        ) from error


def _contents(path: Path, *, keep_frames: bool = False) -> _Contents:
    contents = _Contents(path, keep_frames=keep_frames)
    if not contents.names and contents.repeated is not None:
        # the block that describes the channels is broken: the index repeats it
        contents = _Contents(path, keep_frames=keep_frames, known=contents.repeated)
    if contents.names:
        return contents
    if contents.findings.broken:
        raise BadInputError(
            "the recording is broken: the block that describes the channels cannot be read",
            where=str(path),
            fix="use another copy, or record it again",
        )
    raise BadInputError(f"has no topic {CHANNELS_TOPIC}", where=str(path), fix="is it a hil recording?")


class _Contents:
    """Everything in the file that is whole.

    `known`: schemas and channels to start from; `repeated`: those of the file's index, if it is whole.
    """

    def __init__(self, path: Path, *, keep_frames: bool, known: Definitions | None = None) -> None:
        self.names: list[str] = []
        self.metadata: dict[str, dict[str, str]] = {}
        self.attachments: dict[str, bytes] = {}
        self.events: list[Event] = []
        self.frames: dict[str, list[bytes]] = {}
        self.findings = Findings()
        self.repeated: Definitions | None = None
        self._path = path
        self._keep_frames = keep_frames
        self._unusable_events = 0
        self._rows = Rows()
        self._row_ids: set[int] = set()
        self._payloads: list[npt.NDArray[np.uint8]] = []  # of the rows of the record that is being taken
        self._hash = hashlib.sha256()
        self.definitions: Definitions = ({}, {})
        self._index: Definitions = ({}, {})
        for definitions in known or ():
            for definition in definitions.values():
                self._take(definition)
        self._read(path)
        self.findings.attachments = list(self.attachments)
        self.findings.tables = self.metadata

    def channels(self) -> dict[str, Array] | StoredColumns:
        """Each channel's samples, to be asked for once."""
        return self._rows.channels(self._path, self.names, self._row_ids)

    def notes(self) -> list[str]:
        """What reading remarked."""
        notes = []
        if not self.findings.index_agrees and not self.findings.cut:
            notes.append("the index at the end of the file is damaged; nothing was read from it")
        if self._unusable_events:
            notes.append(
                f"{self._unusable_events} events are not laid out as the project's and were left out"
            )
        return notes

    def _read(self, path: Path) -> None:
        with open_regular(path) as file:
            size = os.fstat(file.fileno()).st_size
            try:
                if file.read(len(MAGIC)) != MAGIC:
                    raise BadInputError("not an MCAP file", where=str(path))
                for position, record in placed_records(file, size):
                    self._take_in_file(record)
                    self._take_rows(position)
                file.seek(max(0, size - len(MAGIC)))
                self.findings.has_last_bytes = file.read() == MAGIC
            except OSError as error:
                raise BadInputError(f"cannot be read: {error.strerror or error}", where=str(path)) from error
        self.findings.samples_sha256 = self._hash.hexdigest()
        if self.names:
            times = self._rows.times(path, self.names, self._row_ids)
            self.findings.sample_times_s, self.findings.sample_time_s = times

    @property
    def _samples(self) -> int:
        return self._rows.count + sum(map(len, self._payloads))

    def _take_in_file(self, record: mcap.Record) -> None:
        """Take what stands in the file itself, not inside a chunk."""
        findings = self.findings
        if findings.data_end is not None:
            self._take_index(record)
            return
        match record:
            case mcap.Chunk():
                for inside in records_inside(record.content):
                    self._take(inside)
            case mcap.Break():
                findings.breaks.append(self._samples)
            case mcap.Attachment(name, content):
                if content is None:
                    findings.bad_attachments.append(name)
                else:
                    self.attachments[name] = content
            case mcap.Metadata(name, table):
                self.metadata[name] = table
            case mcap.DataEnd(agrees):
                findings.data_end = agrees
            case mcap.Other(known=False) | mcap.Named() | mcap.Footer():
                findings.strange.append(self._samples)
            case _:
                self._take(record)
        if isinstance(record, mcap.Footer):
            findings.has_footer = True

    def _take_index(self, record: mcap.Record) -> None:
        schemas, channels = self._index
        match record:
            case mcap.Schema():
                schemas[record.id] = record
            case mcap.Channel():
                channels[record.id] = record
            case mcap.Named(attachment, name):
                self.findings.named.append((attachment, name))
            case mcap.Footer(agrees):
                self.findings.has_footer = True
                self.findings.index_agrees &= agrees
                self.repeated = self._index if self.findings.index_agrees else None
            case mcap.Break():
                self.findings.index_agrees = False
            case _:
                pass

    def _take(self, record: mcap.Record) -> None:
        """Take what may stand inside a chunk."""
        match record:
            case mcap.Schema():
                self.definitions[0][record.id] = record
            case mcap.Channel():
                self._take_channel(record)
            case mcap.Messages(channel_id, payloads):
                channel = self.definitions[1].get(channel_id)
                self._take_messages(channel.topic if channel else "", payloads)
            case mcap.Break():
                self.findings.breaks.append(self._samples)
            case _:
                pass

    def _take_channel(self, channel: mcap.Channel) -> None:
        self.definitions[1][channel.id] = channel
        if channel.topic.startswith(FRAMES_TOPIC):
            self.frames.setdefault(channel.topic.removeprefix(FRAMES_TOPIC), [])
        if channel.topic != CHANNELS_TOPIC:
            return
        self._row_ids.add(channel.id)
        schema = self.definitions[0].get(channel.schema_id)
        try:
            if schema is None:
                raise ValueError("its schema is missing")
            names = _schema.channel_names(schema.name, schema.encoding, schema.data)
            if self.names and names != self.names:
                raise ValueError("it is described twice, and not alike")
        except ValueError as error:
            raise self._foreign(error) from error
        self.names = names

    def _take_messages(self, topic: str, payloads: npt.NDArray[np.uint8]) -> None:
        if topic == CHANNELS_TOPIC:
            self._payloads.append(payloads)
        elif topic == EVENTS_TOPIC:
            for payload in payloads:
                self._take_event(payload.tobytes())
        elif topic.startswith(FRAMES_TOPIC) and self._keep_frames:
            self.frames[topic.removeprefix(FRAMES_TOPIC)] += [payload.tobytes() for payload in payloads]

    def _take_rows(self, position: int) -> None:
        """The samples of the record at `position`, all of them at once."""
        if not self._payloads:
            return
        try:
            rows = _schema.decode_parts(self._payloads, len(self.names))
        except ValueError as error:
            raise self._foreign(error) from error
        for payloads in self._payloads:
            self._hash.update(payloads.tobytes())
        self._payloads = []
        self._rows.add(position, rows)

    def _take_event(self, message: bytes) -> None:
        try:
            event = json.loads(message)
            time_s, kind, text = event["time_s"], event["kind"], event["text"]
            if not (math.isfinite(time_s) and isinstance(kind, str) and isinstance(text, str)):
                raise ValueError
            self.events.append(Event(float(time_s), kind, text))
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            self._unusable_events += 1

    def _foreign(self, error: ValueError) -> BadInputError:
        return BadInputError(
            f"the topic {CHANNELS_TOPIC} is not laid out as the project's: {error}",
            where=str(self._path),
            fix="export it as CSV or Parquet with the tool that made it, one column a channel",
        )


#: Metadata table with units by channel, of a log that was decoded by its DBC.
_UNITS = "units"


def read_mapped_mcap(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """A recording; with a map of columns its channels are assigned, and all are held.

    Raises:
        BadInputError: what `read_mcap` and `recording_of` refuse, or a map for a run of this software.
    """
    recording = read_mcap(path)
    if not columns:
        return recording
    if RUN in recording.attachments:
        raise BadInputError(
            "is a run of this software, whose channels are known", where=str(path), fix="leave out --columns"
        )
    wanted = {source.column.lower() for _, source in columns.columns()}
    kept = [name for name in recording.channels if name in CHANNELS or _may_be(name, wanted)]
    units = recording.metadata.get(_UNITS, {})
    table = {name: Column(recording[name], units.get(name, "")) for name in kept or recording.channels}
    found = recording_of(table, path, columns, "channel", list(recording.notes))
    return replace(
        recording,
        channels=found.channels,
        notes=found.notes,
        metadata={**recording.metadata, **found.metadata},
    )


def _may_be(name: str, wanted: set[str]) -> bool:
    return any(column in name.lower() or name.lower() in column for column in wanted)
