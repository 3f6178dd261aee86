"""Writes the native recording: raw frames and decoded channels in one MCAP, as the run goes on."""

from __future__ import annotations

import contextlib
import hashlib
import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FrameBlock, joined
from hil.core.errors import BenchError
from hil.core.files import full_disk_in_words
from hil.core.recording import _schema
from hil.core.recording._growing_file import GrowingFile
from hil.core.recording._mcap_damage import CHANNELS_TABLE
from hil.core.recording._mcap_file import McapFile

CHANNELS_TOPIC = "/channels"
EVENTS_TOPIC = "/events"
FRAMES_TOPIC = "/can/"
REQUESTS_TOPIC = "/requests"
_MESSAGE_S = 0.045
_ROWS_AT_ONCE = 8192
CHUNK_BYTES = 256 * 1024  # about a second of a bench
_EVENT_SCHEMA = {
    "type": "object",
    "properties": {"time_s": {"type": "number"}, "kind": {"type": "string"}, "text": {"type": "string"}},
}


class RecordingWriter:
    """Streams a run to `path`. Everything added before a crash can be read again.

    A block of the file holds `chunk_bytes` before compression: what a crash or a flipped bit can cost.
    A disk that fills up raises BenchError from any method that writes.

    Args:
        durable: a power cut too costs no more than what was added in the last quarter of a second before.
        clock_0_ns: wall-clock time, ns since 1970, at which the frames' stamps are 0: what other tools show.
        between: called between the parts of work that together takes longer than a millisecond; may add
            nothing here.

    Attributes:
        row_0_s: time of the frames' stamps at which `time_s` is 0: rows and events are logged on their base.
    """

    def __init__(
        self,
        path: Path,
        channel_names: list[str],
        buses: list[str],
        *,
        chunk_bytes: int = CHUNK_BYTES,
        durable: bool = False,
        clock_0_ns: int = 0,
        between: Callable[[], None] = lambda: None,
    ) -> None:
        self.path = path
        self._clock_0_ns, self._between = clock_0_ns, between
        self.row_0_s = 0.0
        self._samples = 0
        self._hash = hashlib.sha256()
        self._waiting: dict[str, list[FrameBlock]] = {bus: [] for bus in buses}
        try:
            self._file = GrowingFile(path, durable=durable)
            self._writer = McapFile(self._file, library="eaxle-hil", chunk_bytes=chunk_bytes, between=between)
            self._register(channel_names, buses)
        except OSError as error:
            raise self._failed(error) from error

    def _register(self, channel_names: list[str], buses: list[str]) -> None:
        writer = self._writer
        channels = writer.schema(_schema.CHANNELS_TYPE, "protobuf", _schema.channels_schema(channel_names))
        frames = writer.schema(_schema.FRAMES_TYPE, "protobuf", _schema.frames_schema())
        events = writer.schema("hil.Event", "jsonschema", json.dumps(_EVENT_SCHEMA).encode())
        requests = writer.schema(_schema.REQUESTS_TYPE, "protobuf", _schema.requests_schema())
        self._channels = writer.channel(CHANNELS_TOPIC, "protobuf", channels)
        self._events = writer.channel(EVENTS_TOPIC, "json", events)
        self._requests = writer.channel(REQUESTS_TOPIC, "protobuf", requests)
        self._frames = {bus: writer.channel(FRAMES_TOPIC + bus, "protobuf", frames) for bus in buses}

    def add_frames(self, bus: str, block: FrameBlock) -> None:
        """Add the frames of one bus, as they came; they become messages of about 50 ms."""
        if not len(block):
            return
        waiting = self._waiting[bus]
        waiting.append(block)
        if block["time_s"][-1] - waiting[0]["time_s"][0] > _MESSAGE_S:
            self._flush_frames(bus)

    def _flush_frames(self, bus: str) -> None:
        waiting = self._waiting[bus]
        if waiting:
            self._waiting[bus] = []
            block = joined(waiting)
            # an adapter may hand out frames from before the clock began; MCAP knows no time before 0
            logged_s = max(0.0, float(block["time_s"][-1]))
            self._add(self._frames[bus], logged_s, _schema.encode_frames(block))

    def add_rows(self, rows: npt.NDArray[np.float64]) -> None:
        """Add decoded samples (samples x channels; the first column is `time_s`)."""
        if not len(rows):
            return
        self._writer.slow = self._channels  # frames come at once, samples when all of their frames are there
        for start in range(0, len(rows), _ROWS_AT_ONCE):
            self._add_block(rows[start : start + _ROWS_AT_ONCE])

    def _add_block(self, rows: npt.NDArray[np.float64]) -> None:
        encoded = _schema.encode_rows(rows)
        self._samples += len(rows)
        self._hash.update(encoded.data)
        try:
            logged_ns = np.rint((rows[:, 0] + self.row_0_s) * 1e9).astype(np.int64) + self._clock_0_ns
            self._writer.add(self._channels, logged_ns, encoded)
        except OSError as error:
            raise self._failed(error) from error

    def add_event(self, time_s: float, kind: str, text: str, *, logged_s: float | None = None) -> None:
        """Add one event of the run; `logged_s` is its time on the base of the frames' stamps, if known."""
        message = json.dumps({"time_s": round(time_s, 6), "kind": kind, "text": text}).encode()
        self._add(self._events, time_s + self.row_0_s if logged_s is None else logged_s, message)

    def add_requests(self, request: str, logged_s: float, times_s: npt.NDArray[np.float64]) -> None:
        """Add when some periodic requests were meant, sent and seen on the bus, s, shape (3, n)."""
        self._add(self._requests, logged_s, _schema.encode_requests(request, times_s))

    def attach(self, name: str, content: bytes, media_type: str = "text/plain") -> None:
        """Store a file with the data."""
        try:
            self._writer.attach(name, media_type, content, time.time_ns())
        except OSError as error:
            raise self._failed(error) from error

    def describe(self, name: str, table: Mapping[str, str]) -> None:
        """Store a named table of text."""
        try:
            self._writer.describe(name, dict(table))
        except OSError as error:
            raise self._failed(error) from error

    def flush(self) -> None:
        """Hand over to the operating system what was added until now: a killed process loses none of it.

        If it is to be durable, a thread does that, as soon as the disk takes it. Frames that are newer than
        the newest row wait for theirs, a quarter of a second at most.
        """
        try:
            for bus in self._frames:
                self._flush_frames(bus)
                self._between()
            self._writer.flush()
        except OSError as error:
            raise self._failed(error) from error

    def settle(self) -> None:
        """Return when whoever reads the file finds all that was flushed."""
        self._file.settle()

    def close(self) -> None:
        """Finish the file; it can be read without this, but then what was not flushed is missing."""
        try:
            with contextlib.closing(self._file):
                for bus in self._frames:
                    self._flush_frames(bus)
                self.describe(
                    CHANNELS_TABLE, {"sha256": self._hash.hexdigest(), "samples": str(self._samples)}
                )
                self._writer.finish()
        except OSError as error:
            raise self._failed(error) from error

    def _add(self, channel: int, time_s: float, message: bytes) -> None:
        stamps = np.array([self._clock_0_ns + round(time_s * 1e9)], np.int64)
        try:
            self._writer.add(channel, stamps, np.frombuffer(message, np.uint8).reshape(1, -1))
        except OSError as error:
            raise self._failed(error) from error

    def _failed(self, error: OSError) -> BenchError:
        return BenchError(
            f"the recording cannot be written: {full_disk_in_words(error, self.path)}",
            where=str(self.path),
            fix="free disk space, or choose another place with --out",
        )
