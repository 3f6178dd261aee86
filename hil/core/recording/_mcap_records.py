"""The records of an MCAP file, one at a time: each is whole, or it is none."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from mcap import records as mcap_records
from mcap.opcode import Opcode
from mcap.stream_reader import get_chunk_data_stream

MESSAGE_HEAD = 22  # channel, sequence, two times
_LARGEST_CHUNK = 1 << 30  # bytes uncompressed; a flipped bit must not ask for more


@dataclass(frozen=True)
class Break:
    """A stretch of the file without an intact record; `to_end`: nothing intact follows."""

    to_end: bool


@dataclass(frozen=True)
class Chunk:
    """A block of records whose checksum agrees, or has none."""

    content: bytes


@dataclass(frozen=True)
class Attachment:
    """A stored file, when it was stored; `content` is None if its checksum disagrees."""

    name: str
    content: bytes | None
    media_type: str = "text/plain"
    stored_ns: int = 0


@dataclass(frozen=True)
class Metadata:
    """A named table of text."""

    name: str
    table: dict[str, str]


@dataclass(frozen=True)
class Schema:
    """Describes the messages of channels."""

    id: int
    name: str
    encoding: str
    data: bytes


@dataclass(frozen=True)
class Channel:
    """A topic and the schema of its messages."""

    id: int
    schema_id: int
    topic: str
    encoding: str = ""


@dataclass(frozen=True)
class Messages:
    """Messages of one channel and one length that follow each other, one row of bytes each; `times` in ns."""

    channel_id: int
    payloads: npt.NDArray[np.uint8]
    times: npt.NDArray[np.int64]


@dataclass(frozen=True)
class DataEnd:
    """End of the data; `agrees`: with the checksum of all before it, where there is one."""

    agrees: bool


@dataclass(frozen=True)
class Footer:
    """End of the file's index; `agrees`: with the checksum of the index, where there is one."""

    agrees: bool


@dataclass(frozen=True)
class Named:
    """An entry of the index: an attachment or a metadata table of this name is in the file."""

    attachment: bool
    name: str


@dataclass(frozen=True)
class Other:
    """A record that says nothing here; `known`: it may stand among the data."""

    known: bool


Record: TypeAlias = (
    Break | Chunk | Attachment | Metadata | Schema | Channel | Messages | DataEnd | Footer | Named | Other
)


class _BrokenRecordError(ValueError):
    """The fields of a record do not fill it."""


class _Fields:
    """The fields of a record's body, one after the other."""

    def __init__(self, body: memoryview) -> None:
        self._rest = body

    def take(self, count: int) -> memoryview:
        if count > len(self._rest):
            raise _BrokenRecordError
        taken, self._rest = self._rest[:count], self._rest[count:]
        return taken

    def number(self, size: int) -> int:
        return int.from_bytes(self.take(size), "little")

    def text(self) -> str:
        return str(self.take(self.number(4)), "utf-8")

    def table(self) -> dict[str, str]:
        inside = _Fields(self.take(self.number(4)))
        table = {}
        while inside._rest:
            key = inside.text()
            table[key] = inside.text()
        return table

    def end(self) -> None:
        if self._rest:
            raise _BrokenRecordError


def parsed(opcode: int, body: memoryview) -> Record | None:
    """The record, None if it is broken: its fields do not fill it, or its checksum disagrees."""
    if opcode == 0:
        return None
    fields = _Fields(body)
    try:
        match opcode:
            case Opcode.CHUNK:
                return _chunk(fields)
            case Opcode.ATTACHMENT:
                return _attachment(fields, body)
            case Opcode.MESSAGE:
                fields.take(MESSAGE_HEAD)
                return messages(np.frombuffer(body, np.uint8).reshape(1, -1))
            case _:
                record = _described(opcode, fields)
                fields.end()
                return record
    except ValueError:  # also text that is not UTF-8
        return None


def messages(bodies: npt.NDArray[np.uint8]) -> Messages:
    """Bodies of messages of one channel and one length, shape (n, bytes)."""
    times = np.ascontiguousarray(bodies[:, 6:14]).view("<i8")[:, 0]
    return Messages(int(bodies[0, 0]) | int(bodies[0, 1]) << 8, bodies[:, MESSAGE_HEAD:], times)


def _described(opcode: int, fields: _Fields) -> Record:
    match opcode:
        case Opcode.HEADER:
            fields.text(), fields.text()
        case Opcode.SCHEMA:
            return Schema(
                fields.number(2), fields.text(), fields.text(), bytes(fields.take(fields.number(4)))
            )
        case Opcode.CHANNEL:
            channel = Channel(fields.number(2), fields.number(2), fields.text(), fields.text())
            fields.table()
            return channel
        case Opcode.METADATA:
            return Metadata(fields.text(), fields.table())
        case Opcode.MESSAGE_INDEX:
            fields.take(2)
            fields.take(fields.number(4))
        case Opcode.DATA_END:
            fields.take(4)
            return DataEnd(agrees=True)
        case Opcode.FOOTER:
            fields.take(20)
            return Footer(agrees=True)
        case Opcode.ATTACHMENT_INDEX:
            fields.take(40)
            name = fields.text()
            fields.text()
            return Named(True, name)
        case Opcode.METADATA_INDEX:
            fields.take(16)
            return Named(False, fields.text())
        case _:
            fields.take(len(fields._rest))
            return Other(known=False)
    return Other(known=True)


def _chunk(fields: _Fields) -> Chunk | None:
    fields.take(16)
    size, checksum = fields.number(8), fields.number(4)
    compression = fields.text()
    data = bytes(fields.take(fields.number(8)))
    fields.end()
    if size > _LARGEST_CHUNK:
        return None
    packed = mcap_records.Chunk(compression, data, 0, 0, checksum, size)
    if compression not in ("", "zstd", "lz4"):
        return None
    try:
        stream, length = get_chunk_data_stream(packed, validate_crc=True)
        content = stream.read(length)
    except Exception:  # zstandard, lz4 and mcap raise kinds of their own
        return None
    return Chunk(content) if length == size else None


def _attachment(fields: _Fields, body: memoryview) -> Attachment:
    stored_ns = fields.number(8)
    fields.take(8)
    name = str(fields.take(fields.number(4)), "utf-8", "replace")
    media_type = str(fields.take(fields.number(4)), "utf-8", "replace")
    content = fields.take(fields.number(8))
    checksum = fields.number(4)
    fields.end()
    intact = checksum == 0 or checksum == zlib.crc32(body[:-4])
    return Attachment(name, bytes(content) if intact else None, media_type, stored_ns)
