"""Reads the native recording back, also one that was cut by a crash."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf import descriptor_pb2
from mcap.records import Attachment, Channel, Footer, Message, Metadata, Schema
from mcap.stream_reader import StreamReader

from hil.core.errors import BadInputError
from hil.core.frames import FRAME, FrameBlock, empty_block
from hil.core.recording._mcap_writer import CHANNELS_TOPIC, EVENTS_TOPIC, FRAMES_TOPIC
from hil.core.recording._table import Event, Recording
from hil.core.recording._tables_on_disk import read_bytes_or_explain

_MAGIC = b"\x89MCAP0\r\n"


def read_mcap(path: Path) -> Recording:
    """Channels, events, attachments and metadata of a recording."""
    contents = _Contents(path)
    rows = contents.rows()
    recording = Recording(
        {name: np.ascontiguousarray(rows[:, column]) for column, name in enumerate(contents.names)},
        path,
        contents.metadata,
        contents.attachments,
        contents.events,
    )
    if contents.cut:
        recording.notes.append(f"the file was cut off ({contents.cut}); what could be read is used")
    return recording


def read_frames(path: Path) -> dict[str, FrameBlock]:
    """Raw frames of each bus, as they came."""
    contents = _Contents(path)
    return {
        bus: np.concatenate([_decode_frames(m) for m in messages]) if messages else empty_block()
        for bus, messages in contents.frames.items()
    }


class _Contents:
    """Everything in the file, up to the first broken record."""

    def __init__(self, path: Path) -> None:
        if read_bytes_or_explain(path) != _MAGIC:
            raise BadInputError("not an MCAP file", where=str(path))
        self.names: list[str] = []
        self.metadata: dict[str, dict[str, str]] = {}
        self.attachments: dict[str, bytes] = {}
        self.events: list[Event] = []
        self.frames: dict[str, list[bytes]] = {}
        self.cut = ""
        self._complete = False
        self._messages: list[bytes] = []
        self._schemas: dict[int, Schema] = {}
        self._topics: dict[int, str] = {}
        self._read(path)
        if not self._messages and self.cut:
            raise BadInputError(
                f"the recording is broken: {self.cut}", where=str(path), fix="record it again"
            )
        if not self.names:
            raise BadInputError(
                f"has no topic {CHANNELS_TOPIC}", where=str(path), fix="is it a hil recording?"
            )

    def rows(self) -> Any:
        width = len(self.names)
        if not self._messages:
            return np.zeros((0, width))
        raw = np.frombuffer(b"".join(self._messages), np.uint8).reshape(len(self._messages), -1)
        tags = [2 if number > 15 else 1 for number in range(1, width + 1)]
        starts = np.cumsum([tag + 8 for tag in tags]) - 8
        cells = np.stack([raw[:, start : start + 8] for start in starts], axis=1)
        return np.ascontiguousarray(cells).view("<f8")[:, :, 0]

    def _read(self, path: Path) -> None:
        with path.open("rb") as file:
            try:
                for record in StreamReader(file, emit_chunks=False).records:
                    self._take(record)
            except Exception as error:  # zstandard and struct raise kinds of their own for a broken chunk
                self.cut = "" if self._complete else str(error) or type(error).__name__

    def _take(self, record: object) -> None:
        match record:
            case Message():
                self._take_message(self._topics[record.channel_id], record.data)
            case Schema():
                self._schemas[record.id] = record
            case Channel():
                self._topics[record.id] = record.topic
                if record.topic == CHANNELS_TOPIC:
                    self.names = _field_names(self._schemas[record.schema_id].data)
                elif record.topic.startswith(FRAMES_TOPIC):
                    self.frames.setdefault(record.topic.removeprefix(FRAMES_TOPIC), [])
            case Attachment():
                self.attachments[record.name] = record.data
            case Footer():
                self._complete = True
            case Metadata():
                self.metadata[record.name] = dict(record.metadata)
            case _:
                pass

    def _take_message(self, topic: str, data: bytes) -> None:
        if topic == CHANNELS_TOPIC:
            self._messages.append(data)
        elif topic == EVENTS_TOPIC:
            event = json.loads(data)
            self.events.append(Event(event["time_s"], event["kind"], event["text"]))
        elif topic.startswith(FRAMES_TOPIC):
            self.frames[topic.removeprefix(FRAMES_TOPIC)].append(data)


def _field_names(schema: bytes) -> list[str]:
    files = descriptor_pb2.FileDescriptorSet.FromString(schema)
    return [f.name for f in files.file[0].message_type[0].field]


def _decode_frames(message: bytes) -> FrameBlock:
    columns: dict[str, Any] = {}
    position = 0
    for name in ("time_s", "id", "flags", "length", "data"):
        position += 1  # the tag; the schema fixes the order
        size = shift = 0
        while True:
            byte = message[position]
            position += 1
            size |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        columns[name] = np.frombuffer(message[position : position + size], FRAME[name])
        position += size
    block = np.zeros(len(columns["id"]), FRAME)
    for name, column in columns.items():
        block[name] = column
    return block
