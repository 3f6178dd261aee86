"""Protocol Buffers schemas of the MCAP topics, built in code so that every file describes itself."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from google.protobuf import descriptor_pb2

from hil.core.frames import FRAME

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


def encode_rows(rows: npt.NDArray[np.float64]) -> npt.NDArray[np.uint8]:
    """Channels messages of `rows` (samples x channels), one row of bytes for each sample."""
    count, width = rows.shape
    tags = [_varint((number << 3) | 1) for number in range(1, width + 1)]
    size = sum(len(tag) + 8 for tag in tags)
    encoded = np.empty((count, size), np.uint8)
    raw = np.ascontiguousarray(rows, "<f8").view(np.uint8).reshape(count, width, 8)
    position = 0
    for column, tag in enumerate(tags):
        encoded[:, position : position + len(tag)] = np.frombuffer(tag, np.uint8)
        position += len(tag)
        encoded[:, position : position + 8] = raw[:, column]
        position += 8
    return encoded


def encode_frames(block: npt.NDArray[np.void]) -> bytes:
    """One CanFrames message."""
    count = len(block)
    parts = []
    for name, tag in _FRAME_TAGS.items():
        parts.append(tag + _varint(count * FRAME[name].itemsize))
        parts.append(block[name].tobytes())
    return b"".join(parts)


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
