"""When the periodic requests of a run were meant and sent, from its recording."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import numpy.typing as npt
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader
from mcap.records import Schema


def requests_of(recording: bytes, request: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Times that the cycles of one request were meant and sent, s since 1970."""
    reader, kinds = make_reader(io.BytesIO(recording)), dict[str, Any]()
    clock_0_s, meant_s, sent_s = np.nan, [np.zeros(0)], [np.zeros(0)]
    for schema, channel, message in reader.iter_messages():
        if schema is None or schema.name not in ("hil.CanFrames", "hil.Requests"):
            continue
        kind = kinds.get(schema.name) or kinds.setdefault(schema.name, _kind_of(schema))
        if channel.topic != "/requests" and np.isnan(clock_0_s):
            clock_0_s = message.log_time * 1e-9 - kind.FromString(message.data).time_s[-1]
        elif channel.topic == "/requests":
            some = kind.FromString(message.data)
            if some.request == request:
                meant_s.append(np.array(some.meant_s))
                sent_s.append(np.array(some.sent_s))
    return clock_0_s + np.concatenate(meant_s), clock_0_s + np.concatenate(sent_s)


def _kind_of(schema: Schema) -> Any:
    """The class of a schema's messages."""
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
