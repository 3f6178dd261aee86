"""Reads a recording while another process writes it: what has come since the last look."""

from __future__ import annotations

import contextlib
import json
import math
import os
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.files import open_regular
from hil.core.recording import _mcap_records as mcap
from hil.core.recording import _schema
from hil.core.recording._mcap_walk import MAGIC, RECORD_HEAD, raw_record, records_inside
from hil.core.recording._mcap_writer import CHANNELS_TOPIC, EVENTS_TOPIC
from hil.core.recording._table import Event


class FollowedRecording:
    """A growing MCAP recording, read from its beginning and then as it grows.

    Only whole records are taken; one that is being written is taken at a later look. Who follows costs the
    process that writes nothing.

    Attributes:
        names: of the channels, `time_s` first; empty until their description has been written.
        tables: metadata by name, such as `segment/<id>`.
        events: all until now.
        over: whether the file has been closed by its writer.

    Raises:
        BadInputError: the file cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._file = path, open_regular(path)
        self._position = len(MAGIC)
        self._schemas: dict[int, mcap.Schema] = {}
        self._topics: dict[int, str] = {}
        self.names: list[str] = []
        self.tables: dict[str, dict[str, str]] = {}
        self.events: list[Event] = []
        self.over = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()

    @property
    def row_ids(self) -> frozenset[int]:
        """The file's own numbers of the channels whose messages are rows of samples."""
        return frozenset(one for one, topic in self._topics.items() if topic == CHANNELS_TOPIC)

    def fetch(self) -> npt.NDArray[np.float64]:
        """Rows of samples since the last call, shape (samples, channels).

        Raises:
            BadInputError: the file is no recording of the project, or broken.
        """
        rows = [part for _, part in self.fetch_parts()]
        return np.concatenate(rows) if rows else np.zeros((0, len(self.names)))

    def fetch_parts(self, most_bytes: float = math.inf) -> list[tuple[int, npt.NDArray[np.float64]]]:
        """The same by records, each with where it stands in the file; stops after so many bytes of rows.

        Raises:
            BadInputError: like `fetch`.
        """
        parts: list[tuple[int, npt.NDArray[np.float64]]] = []
        taken = 0
        size = os.fstat(self._file.fileno()).st_size
        while (
            not self.over
            and taken < most_bytes
            and (found := raw_record(self._file, self._position, size)) is not None
        ):
            opcode, body = found
            record = mcap.parsed(opcode, body)
            if record is None:
                raise BadInputError(
                    "the recording is broken", where=str(self._path), fix="hil evidence recover"
                )
            position, self._position = self._position, self._position + RECORD_HEAD + len(body)
            records = records_inside(record.content) if isinstance(record, mcap.Chunk) else [record]
            rows = [part for inside in records for part in self._take(inside)]
            if rows:
                parts.append((position, np.concatenate(rows)))
                taken += parts[-1][1].nbytes
        return parts

    def _take(self, record: mcap.Record) -> list[npt.NDArray[np.float64]]:
        match record:
            case mcap.Schema():
                self._schemas[record.id] = record
            case mcap.Channel():
                self._take_channel(record)
            case mcap.Messages(channel_id, payloads):
                topic = self._topics.get(channel_id)
                if topic == CHANNELS_TOPIC:
                    return [_schema.decode_rows(payloads, len(self.names))]
                if topic == EVENTS_TOPIC:
                    self._take_events(payloads)
            case mcap.Metadata(name, table):
                self.tables[name] = dict(table)
            case mcap.DataEnd():
                self.over = True
            case _:
                pass
        return []

    def _take_channel(self, channel: mcap.Channel) -> None:
        self._topics[channel.id] = channel.topic
        schema = self._schemas.get(channel.schema_id)
        if channel.topic == CHANNELS_TOPIC and schema is not None:
            self.names = _schema.channel_names(schema.name, schema.encoding, schema.data)

    def _take_events(self, payloads: npt.NDArray[np.uint8]) -> None:
        for payload in payloads:
            with contextlib.suppress(ValueError, KeyError, TypeError):
                event = json.loads(payload.tobytes())
                self.events.append(Event(float(event["time_s"]), str(event["kind"]), str(event["text"])))
