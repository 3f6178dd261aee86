"""Walks an MCAP file record by record; after a broken one it goes on at the next that is whole."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from itertools import chain
from typing import BinaryIO

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode

from hil.core.recording._mcap_records import (
    MESSAGE_HEAD,
    Attachment,
    Break,
    DataEnd,
    Footer,
    Other,
    Record,
    messages,
    parsed,
)

MAGIC = b"\x89MCAP0\r\n"
RECORD_HEAD = 9  # opcode, length
_SCAN_BYTES = 1 << 20
#: What reading may resume at: records that a broken block cannot hold by chance.
_RESUME_AT = np.zeros(256, bool)
_RESUME_AT[
    [Opcode.CHUNK, Opcode.MESSAGE_INDEX, Opcode.ATTACHMENT, Opcode.METADATA, Opcode.DATA_END, Opcode.FOOTER]
] = True


def records(file: BinaryIO, size: int) -> Iterator[Record]:
    """Records of a file of `size` bytes, in order, each intact stretch of them; `Break` in between.

    Raises:
        OSError: the file cannot be read.
    """
    return (record for _, record in placed_records(file, size))


def placed_records(file: BinaryIO, size: int) -> Iterator[tuple[int, Record]]:
    """The same, each with the place in the file at which it begins.

    Raises:
        OSError: the file cannot be read.
    """
    position = len(MAGIC)
    checksum: int | None = zlib.crc32(MAGIC)
    while position < size:
        found = raw_record(file, position, size)
        record = parsed(*found) if found else None
        if found is None or record is None:
            position = _next_intact(file, position, size)
            checksum = None  # of a broken file it says nothing new
            yield position, Break(to_end=position == size)
            continue
        opcode, body = found
        began, position = position, position + RECORD_HEAD + len(body)
        head = bytes([opcode]) + len(body).to_bytes(8, "little")
        if isinstance(record, DataEnd):
            yield began, DataEnd(_agrees(int.from_bytes(body, "little"), checksum))
            checksum = 0
            continue
        if isinstance(record, Footer):
            summary = None if checksum is None else zlib.crc32(head + bytes(body[:16]), checksum)
            yield began, Footer(_agrees(int.from_bytes(body[16:], "little"), summary))
            return
        if checksum is not None:
            checksum = zlib.crc32(body, zlib.crc32(head, checksum))
        yield began, record


def records_inside(content: bytes) -> Iterator[Record]:
    """Records of a chunk, `Break` as the last if it does not hold together."""
    data = np.frombuffer(content, np.uint8)
    position = 0
    while position < len(content):
        opcode = content[position]
        end = (
            position + RECORD_HEAD + int.from_bytes(content[position + 1 : position + RECORD_HEAD], "little")
        )
        if end > len(content) or position + RECORD_HEAD > len(content):
            yield Break(to_end=False)
            return
        if opcode == Opcode.MESSAGE and end - position >= RECORD_HEAD + MESSAGE_HEAD:
            stride = end - position
            count = _alike(data, position, stride)
            end = position + count * stride
            rows = data[position:end].reshape(count, stride)
            yield messages(rows[:, RECORD_HEAD:])
        else:
            yield parsed(opcode, memoryview(content)[position + RECORD_HEAD : end]) or Break(to_end=False)
        position = end


def _alike(data: npt.NDArray[np.uint8], position: int, stride: int) -> int:
    """How many messages of the same channel and length follow each other from `position` on."""
    limit = (len(data) - position) // stride
    if limit < 2 or not _same_head(data, position, position + stride):
        return 1
    head = data[position : position + RECORD_HEAD + 2]
    count, step = 1, 32
    while count < limit:
        ahead = min(step, limit - count)
        start = position + count * stride
        rows = data[start : start + ahead * stride].reshape(ahead, stride)
        same = (rows[:, : len(head)] == head).all(axis=1)
        if not same.all():
            return count + int(same.argmin())
        count, step = count + ahead, step * 4
    return count


def _same_head(data: npt.NDArray[np.uint8], one: int, other: int) -> bool:
    """Whether two messages are of one channel and length; faster than arrays for the many that are alone."""
    return data[one : one + RECORD_HEAD + 2].tobytes() == data[other : other + RECORD_HEAD + 2].tobytes()


def _agrees(stored: int, computed: int | None) -> bool:
    return stored == 0 or computed is None or stored == computed


def raw_record(file: BinaryIO, position: int, size: int) -> tuple[int, memoryview] | None:
    """Opcode and body at `position`; None if they do not fit into the file of `size` bytes."""
    file.seek(position)
    head = file.read(RECORD_HEAD)
    length = int.from_bytes(head[1:], "little")
    if len(head) < RECORD_HEAD or length > size - position - RECORD_HEAD:
        return None
    body = file.read(length)
    return (head[0], memoryview(body)) if len(body) == length else None


def _next_intact(file: BinaryIO, broken: int, size: int) -> int:
    """Where reading can go on after a broken record; `size` if nowhere."""
    file.seek(broken + 1)
    declared = broken + RECORD_HEAD + int.from_bytes(file.read(8), "little")
    for position in chain([declared] if declared < size else [], _candidates(file, broken + 1, size)):
        found = raw_record(file, position, size)
        record = parsed(*found) if found else None
        if record is None or (isinstance(record, Other) and not record.known):
            continue
        if isinstance(record, Attachment) and record.content is None:
            continue
        return position
    return size


def _candidates(file: BinaryIO, start: int, size: int) -> Iterator[int]:
    """Places from `start` on that look like the head of a record."""
    for window in range(start, size, _SCAN_BYTES):
        file.seek(window)
        data = np.frombuffer(file.read(_SCAN_BYTES + RECORD_HEAD), np.uint8)
        count = len(data) - RECORD_HEAD + 1
        if count <= 0:
            return
        looks = _RESUME_AT[data[:count]]
        for upper in range(5, 9):  # no record is longer than 4 GiB
            looks &= data[upper : upper + count] == 0
        yield from (window + np.flatnonzero(looks)).tolist()
