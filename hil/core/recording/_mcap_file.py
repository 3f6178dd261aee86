"""Writes an MCAP file chunk by chunk; thousands of messages of one length are one array.

The library's writer makes an object of every message, which takes a fifth of a run in virtual time. Every
record but the messages and their index is still written by the library's own classes.
"""

from __future__ import annotations

import struct
import zlib
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt
import zstandard
from mcap import records as mcap
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode

Bytes: TypeAlias = npt.NDArray[np.uint8]
Times: TypeAlias = npt.NDArray[np.int64]

MAGIC = b"\x89MCAP0\r\n"
_LEVEL = 1  # half the time of the usual 3 for a file a sixth longer
_HEAD = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log", "<u8"),
        ("publish", "<u8"),
    ]
)
_BEFORE_LENGTH = 9  # opcode and length, which the length does not count
_ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
_PATIENCE = 4  # chunks that wait for a slow channel before they are written out of order
_PATIENCE_NS = 250_000_000  # likewise, when as much as possible is asked for
_UNSETTLED_NS = 20_000_000  # channels come this much apart


class Output(Protocol):
    """What a file is written to."""

    def write(self, data: bytes) -> int:
        """Write all of it."""

    def tell(self) -> int:
        """Bytes so far."""


@dataclass
class _Messages:
    """Records of messages of one channel and one length, shape (n, bytes), and their times in ns."""

    channel: int
    times: Times
    records: Bytes


@dataclass
class _Index:
    """What the end of the file repeats."""

    schemas: list[mcap.Schema] = field(default_factory=list)
    channels: list[mcap.Channel] = field(default_factory=list)
    chunks: bytearray = field(default_factory=bytearray)  # as records: a long run has many
    chunk_count: int = 0
    first: int = 0
    last: int = 0
    attachments: list[mcap.AttachmentIndex] = field(default_factory=list)
    tables: list[mcap.MetadataIndex] = field(default_factory=list)
    messages: defaultdict[int, int] = field(default_factory=lambda: defaultdict(int))

    def add_chunk(self, chunk: mcap.ChunkIndex) -> None:
        """Take a chunk into the index."""
        first, last = chunk.message_start_time, chunk.message_end_time
        self.first = min(self.first, first) if self.chunk_count else first
        self.last = max(self.last, last)
        self.chunk_count += 1
        self.chunks += _written(chunk)

    def groups(self) -> Iterator[tuple[int, bytes]]:
        """Records by kind, in the order of the file."""
        statistics = mcap.Statistics(
            attachment_count=len(self.attachments),
            channel_count=len(self.channels),
            channel_message_counts=self.messages,
            chunk_count=self.chunk_count,
            message_count=sum(self.messages.values()),
            message_start_time=self.first,
            message_end_time=self.last,
            metadata_count=len(self.tables),
            schema_count=len(self.schemas),
        )
        yield Opcode.SCHEMA, _written(*self.schemas)
        yield Opcode.CHANNEL, _written(*self.channels)
        yield Opcode.STATISTICS, _written(statistics)
        yield Opcode.CHUNK_INDEX, bytes(self.chunks)
        yield Opcode.ATTACHMENT_INDEX, _written(*self.attachments)
        yield Opcode.METADATA_INDEX, _written(*self.tables)


class McapFile:
    """An MCAP file that grows at its end, with its messages in order of time.

    All that was written can be read after a crash. Every method raises OSError if it cannot write.

    Args:
        chunk_bytes: size before compression beyond which a chunk is written.
        between: called between the parts of writing a chunk; may add nothing here.

    Attributes:
        slow: channel whose messages come later than those of the same time of other channels; these wait
            for it, some chunks at most.
    """

    def __init__(
        self, output: Output, *, library: str, chunk_bytes: int, between: Callable[[], None] = lambda: None
    ) -> None:
        self.slow = 0
        self._output = output
        self._chunk_bytes, self._between = chunk_bytes, between
        self._compressor = zstandard.ZstdCompressor(level=_LEVEL)
        self._index = _Index()
        self._definitions = b""
        self._waiting: list[_Messages] = []
        self._waiting_bytes = 0
        self._slow_until = -1
        self._sequence = 0
        self._checksum = 0
        self._put(MAGIC + _written(mcap.Header("", library)))

    def schema(self, name: str, encoding: str, data: bytes) -> int:
        """Describe messages; the schema's id."""
        schema = mcap.Schema(id=len(self._index.schemas) + 1, data=data, encoding=encoding, name=name)
        self._index.schemas.append(schema)
        self._definitions += _written(schema)
        return len(self._index.schemas)

    def channel(self, topic: str, encoding: str, schema: int) -> int:
        """Open a channel; its id."""
        channel = mcap.Channel(
            id=len(self._index.channels) + 1,
            topic=topic,
            message_encoding=encoding,
            metadata={},
            schema_id=schema,
        )
        self._index.channels.append(channel)
        self._definitions += _written(channel)
        return len(self._index.channels)

    def add(self, channel: int, times: Times, payloads: Bytes) -> None:
        """Add messages, the rows of `payloads`, shape (n, bytes), at increasing `times` in ns, shape (n,)."""
        at_once = max(1, self._chunk_bytes // (_HEAD.itemsize + payloads.shape[1]))
        for start in range(0, len(payloads), at_once):
            part = slice(start, start + at_once)
            self._add(channel, times[part], payloads[part])

    def attach(self, name: str, media_type: str, content: bytes, stored_ns: int) -> None:
        """Store a file; `stored_ns` since 1970."""
        offset = self._output.tell()
        length = self._put(_written(mcap.Attachment(stored_ns, stored_ns, name, media_type, content)))
        self._index.attachments.append(
            mcap.AttachmentIndex(offset, length, stored_ns, stored_ns, len(content), name, media_type)
        )

    def describe(self, name: str, table: dict[str, str]) -> None:
        """Store a named table of text."""
        offset = self._output.tell()
        length = self._put(_written(mcap.Metadata(name, table)))
        self._index.tables.append(mcap.MetadataIndex(offset, length, name))

    def flush(self) -> None:
        """Write what waits; what is newer than the slow channel only if it has waited for it long enough."""
        if not self._waiting:
            return
        first = min(int(some.times[0]) for some in self._waiting)
        last = max(int(some.times[-1]) for some in self._waiting)
        until = self._slow_until if self.slow else last - _UNSETTLED_NS
        if last - max(first, until) > _PATIENCE_NS:
            self._write_chunk(self._waiting)
            self._waiting, self._waiting_bytes = [], 0
        else:
            self._write_until(until, least_bytes=0)

    def finish(self) -> None:
        """Write what waits, the index and the end of the file."""
        if self._waiting:
            self._write_chunk(self._waiting)
        self._put(_written(mcap.DataEnd(self._checksum)))
        start = position = self._output.tell()
        summary, offsets = b"", b""
        for opcode, group in self._index.groups():
            if group:
                offsets += _written(mcap.SummaryOffset(opcode, position, len(group)))
            summary += group
            position += len(group)
        summary += offsets
        head = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, position)
        checksum = zlib.crc32(head, zlib.crc32(summary))
        self._output.write(summary + _written(mcap.Footer(start, position, checksum)) + MAGIC)

    def _put(self, data: bytes) -> int:
        self._checksum = zlib.crc32(data, self._checksum)
        self._output.write(data)
        return len(data)

    def _add(self, channel: int, times: Times, payloads: Bytes) -> None:
        count, size = payloads.shape
        head = np.empty(count, _HEAD)
        head["opcode"], head["channel"] = Opcode.MESSAGE, channel
        head["length"] = _HEAD.itemsize - _BEFORE_LENGTH + size
        head["sequence"] = np.arange(self._sequence + 1, self._sequence + 1 + count)
        head["log"] = head["publish"] = times
        records = np.empty((count, _HEAD.itemsize + size), np.uint8)
        records[:, : _HEAD.itemsize] = head.view(np.uint8).reshape(count, _HEAD.itemsize)
        records[:, _HEAD.itemsize :] = payloads
        self._sequence += count
        self._waiting.append(_Messages(channel, times, records))
        self._waiting_bytes += records.size
        if channel == self.slow:
            self._slow_until = int(times[-1])
        if self._waiting_bytes > self._chunk_bytes:
            self._write_ready()

    def _write_ready(self) -> None:
        """Write what no message that is still to come will precede, or all if that is next to nothing."""
        if not self.slow or self._waiting_bytes > _PATIENCE * self._chunk_bytes:
            self._write_chunk(self._waiting)
            self._waiting, self._waiting_bytes = [], 0
        else:
            self._write_until(self._slow_until, self._chunk_bytes // 2)

    def _write_until(self, until: int, least_bytes: int) -> None:
        ready, later = [], []
        for some in self._waiting:
            split = int(np.searchsorted(some.times, until, "right"))
            if split:
                ready.append(_Messages(some.channel, some.times[:split], some.records[:split]))
            if split < len(some.times):
                later.append(_Messages(some.channel, some.times[split:], some.records[split:]))
        if sum(some.records.size for some in ready) > least_bytes:
            self._write_chunk(ready)
            self._waiting, self._waiting_bytes = later, sum(some.records.size for some in later)

    def _write_chunk(self, ready: list[_Messages]) -> None:
        order = _in_time([some.times for some in ready])
        source, row = order
        content = b"".join([self._definitions, *_slices(ready, source, row)])
        sizes = np.array([some.records.shape[1] for some in ready])[source]
        offsets = len(self._definitions) + np.cumsum(sizes) - sizes
        times = np.concatenate([some.times for some in ready])
        times.sort(kind="stable")
        channels = np.array([some.channel for some in ready])[source]
        self._definitions = b""
        self._between()
        packed = self._compressor.compress(content)
        self._between()
        first, last = int(times[0]), int(times[-1])
        chunk = mcap.Chunk("zstd", packed, last, first, zlib.crc32(content), len(content))
        start = self._output.tell()
        length = self._put(_written(chunk))
        places, index = {}, b""
        for channel in np.unique(channels).tolist():
            of_channel = channels == channel
            places[channel] = start + length + len(index)
            index += _message_index(channel, times[of_channel], offsets[of_channel])
            self._index.messages[channel] += int(of_channel.sum())
        self._put(index)
        self._index.add_chunk(
            mcap.ChunkIndex(
                chunk_length=length,
                chunk_start_offset=start,
                compression="zstd",
                compressed_size=len(packed),
                message_end_time=last,
                message_index_length=len(index),
                message_index_offsets=places,
                message_start_time=first,
                uncompressed_size=len(content),
            )
        )


def _in_time(times: list[Times]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """For each message in order of time: which of `times` it is from, and its place there."""
    source = np.repeat(np.arange(len(times)), [len(some) for some in times])
    row = np.concatenate([np.arange(len(some)) for some in times])
    order = np.argsort(np.concatenate(times), kind="stable")
    return source[order], row[order]


def _slices(
    ready: list[_Messages], source: npt.NDArray[np.intp], row: npt.NDArray[np.intp]
) -> Iterator[memoryview]:
    """The records in that order, as few stretches of memory."""
    breaks = np.flatnonzero((np.diff(source) != 0) | (np.diff(row) != 1)) + 1
    starts = [0, *breaks.tolist()]
    for start, end in zip(starts, [*starts[1:], len(source)], strict=True):
        first = int(row[start])
        yield ready[int(source[start])].records[first : first + end - start].data


def _message_index(channel: int, times: Times, offsets: npt.NDArray[np.int64]) -> bytes:
    entries = np.empty(len(times), _ENTRY)
    entries["time"], entries["offset"] = times, offsets
    content = entries.tobytes()
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + len(content), channel, len(content)) + content


def _written(*records: mcap.McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())
