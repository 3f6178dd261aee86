"""Protocol Buffers schemas of the MCAP topics, built in code so that every file describes itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from google.protobuf import descriptor_pb2
from google.protobuf.message import DecodeError

from hil.core.can.frames import FRAME, FrameBlock
from hil.core.errors.wording import repeated

# Tags of CanFrames' fields, all of wire type 2 (length, then bytes)
_FRAME_TAGS = {
    name: bytes([number << 3 | 2])
    for number, name in enumerate(("time_s", "id", "flags", "length", "data"), 1)
}
_Field = descriptor_pb2.FieldDescriptorProto
_Type: TypeAlias = "descriptor_pb2.FieldDescriptorProto._Type.ValueType"
_Label: TypeAlias = "descriptor_pb2.FieldDescriptorProto._Label.ValueType"
CHANNELS_TYPE = "hil.Channels"
FRAMES_TYPE = "hil.CanFrames"
REQUESTS_TYPE = "hil.Requests"


def channels_schema(names: list[str]) -> bytes:
    """FileDescriptorSet of a message with one double for each channel."""
    fields = [(name, _Field.TYPE_DOUBLE, _Field.LABEL_OPTIONAL) for name in names]
    return _file("Channels", fields)


def frames_schema() -> bytes:
    """FileDescriptorSet of a block of CAN frames, one packed column for each property."""
    return _file(
        "CanFrames",
        [
            ("time_s", _Field.TYPE_DOUBLE, _Field.LABEL_REPEATED),
            ("id", _Field.TYPE_FIXED32, _Field.LABEL_REPEATED),
            ("flags", _Field.TYPE_BYTES, _Field.LABEL_OPTIONAL),
            ("length", _Field.TYPE_BYTES, _Field.LABEL_OPTIONAL),
            ("data", _Field.TYPE_FIXED64, _Field.LABEL_REPEATED),
        ],
    )


def requests_schema() -> bytes:
    """FileDescriptorSet of some periodic requests: when each was meant, sent and seen on the bus."""
    times = [(name, _Field.TYPE_DOUBLE, _Field.LABEL_REPEATED) for name in ("meant_s", "sent_s", "seen_s")]
    return _file("Requests", [("request", _Field.TYPE_STRING, _Field.LABEL_OPTIONAL), *times])


def encode_requests(request: str, times_s: npt.NDArray[np.float64]) -> bytes:
    """One Requests message; `times_s` meant, sent and seen (NaN: not seen), shape (3, n)."""
    columns = [request.encode(), *(np.ascontiguousarray(row, "<f8").tobytes() for row in times_s)]
    parts = [bytes([number << 3 | 2]) + _varint(len(c)) + c for number, c in enumerate(columns, 1)]
    return b"".join(parts)


def channel_names(name: str, encoding: str, schema: bytes) -> list[str]:
    """Names of the doubles that a Channels message holds, in order.

    Raises:
        ValueError: tells in which way the schema is not a plain row of doubles.
    """
    if encoding != "protobuf":
        raise ValueError(f"its schema is '{encoding}', not protobuf")
    try:
        files = descriptor_pb2.FileDescriptorSet.FromString(schema).file
        found = {f"{file.package}.{m.name}".lstrip("."): m.field for file in files for m in file.message_type}
    except (DecodeError, UnicodeDecodeError) as error:
        raise ValueError("its schema cannot be decoded") from error
    if name not in found:
        raise ValueError(f"its schema does not describe '{name}'")
    fields = found[name]
    for number, field in enumerate(fields, 1):
        if field.number != number:
            raise ValueError(f"field '{field.name}' has number {field.number} at place {number}")
        if field.type != _Field.TYPE_DOUBLE or field.label == _Field.LABEL_REPEATED:
            raise ValueError(f"field '{field.name}' is not one double")
    names = [field.name for field in fields]
    twice = repeated(names)
    if twice:
        raise ValueError(f"field '{twice[0]}' stands twice")
    return names


def encode_rows(rows: npt.NDArray[np.float64]) -> npt.NDArray[np.uint8]:
    """Channels messages of `rows` (samples x channels), one row of bytes for each sample."""
    count, width = rows.shape
    layout = _row_layout(width)
    encoded = np.empty((count, layout.size), np.uint8)
    encoded[:] = layout.template
    values = encoded.view(layout.fields)[:, 0]
    for column, name in enumerate(layout.fields.names or ()):
        values[name] = rows[:, column]
    return encoded


def decode_rows(encoded: npt.NDArray[np.uint8], width: int) -> npt.NDArray[np.float64]:
    """Samples x channels of Channels messages, one row of bytes for each sample.

    Raises:
        ValueError: the messages are not laid out as `encode_rows` does.
    """
    layout = _row_layout(width)
    if encoded.shape[1] != layout.size:
        raise ValueError(f"a message has {encoded.shape[1]} bytes, {layout.size} hold {width} doubles")
    if not np.array_equal(
        encoded[:, layout.tag_places], np.broadcast_to(layout.tags, (len(encoded), len(layout.tags)))
    ):
        raise ValueError("a message holds its fields in another order than its schema")
    return np.take(encoded, layout.value_places, axis=1).view("<f8").astype(np.float64, copy=False)


def decode_parts(parts: Sequence[npt.NDArray[np.uint8]], width: int) -> npt.NDArray[np.float64]:
    """The same of messages that stand apart, `parts` of them, in order.

    Raises:
        ValueError: like `decode_rows`.
    """
    if len({part.shape[1] for part in parts}) == 1:  # at once, which is much faster
        return decode_rows(np.concatenate(parts), width)
    return np.concatenate([np.zeros((0, width)), *(decode_rows(part, width) for part in parts)])


def encode_frames(block: npt.NDArray[np.void]) -> bytes:
    """One CanFrames message."""
    count = len(block)
    parts = []
    for name, tag in _FRAME_TAGS.items():
        parts.append(tag + _varint(count * FRAME[name].itemsize))
        parts.append(block[name].tobytes())
    return b"".join(parts)


def decode_frames(message: bytes) -> FrameBlock:
    """The frames of one CanFrames message.

    Raises:
        ValueError: the message is not laid out as `encode_frames` does.
    """
    columns: dict[str, Any] = {}
    position = 0
    for name, tag in _FRAME_TAGS.items():
        if not message.startswith(tag, position):
            raise ValueError(f"no column '{name}'")
        size, position = _read_varint(message, position + len(tag))
        if position + size > len(message):
            raise ValueError(f"column '{name}' is cut off")
        columns[name] = np.frombuffer(message[position : position + size], FRAME[name])
        position += size
    if len({len(column) for column in columns.values()}) > 1 or position != len(message):
        raise ValueError("the columns are not of one length")
    block = np.zeros(len(columns["id"]), FRAME)
    for name, column in columns.items():
        block[name] = column
    return block


@dataclass(frozen=True)
class _RowLayout:
    """Where tags and values of a Channels message stand."""

    size: int
    tags: npt.NDArray[np.uint8]
    tag_places: npt.NDArray[np.intp]
    value_places: npt.NDArray[np.intp]

    @cached_property
    def template(self) -> npt.NDArray[np.uint8]:
        """A message whose values are zero."""
        template = np.zeros(self.size, np.uint8)
        template[self.tag_places] = self.tags
        return template

    @cached_property
    def fields(self) -> np.dtype[np.void]:
        """The values alone, as the columns of a table."""
        starts = self.value_places[::8].tolist()
        return np.dtype(
            {
                "names": [str(start) for start in starts],
                "formats": ["<f8"] * len(starts),
                "offsets": starts,
                "itemsize": self.size,
            }
        )


@lru_cache(maxsize=16)
def _row_layout(width: int) -> _RowLayout:
    tags = [_varint((number << 3) | 1) for number in range(1, width + 1)]
    is_tag = np.array([place < len(tag) for tag in tags for place in range(len(tag) + 8)], bool)
    return _RowLayout(
        len(is_tag), np.frombuffer(b"".join(tags), np.uint8), np.flatnonzero(is_tag), np.flatnonzero(~is_tag)
    )


def _read_varint(message: bytes, position: int) -> tuple[int, int]:
    """A number, and the position after it."""
    value = 0
    for index, byte in enumerate(message[position : position + 10]):
        value |= (byte & 127) << 7 * index
        if byte < 128:
            return value, position + index + 1
    raise ValueError("a length is cut off")


def _varint(value: int) -> bytes:
    encoded = bytearray()
    while value > 127:
        encoded.append(value & 127 | 128)
        value >>= 7
    encoded.append(value)
    return bytes(encoded)


def _file(message: str, fields: list[tuple[str, _Type, _Label]]) -> bytes:
    file = descriptor_pb2.FileDescriptorProto(name=f"hil/{message}.proto", package="hil", syntax="proto3")
    kind = file.message_type.add(name=message)
    for number, (name, type_, label) in enumerate(fields, 1):
        kind.field.add(name=name, number=number, type=type_, label=label)
    return descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString()
