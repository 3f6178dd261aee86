"""The devices of a bench file as decoders of frames that came long ago."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from drivers import TICK_S, BusLoop, Device, LogWire, Samples, SampleSource, Stream
from hil.core.can.frames import FrameBlock
from hil.core.errors import BadInputError, BenchError
from hil.engine.bench.bench import connections_of
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_tally import known_identifiers
from hil.engine.bench.device_kinds import descriptions_of
from hil.engine.run.recorder import Recorder

_AT_ONCE_S = 0.25


class BenchDecoder:
    """Opens the devices of the buses that a log has, listening, and hands the log's frames to them.

    Args:
        frames: by bus.
        channels: what the log calls each bus.

    Attributes:
        short: frames that end before a signal that should be in them; the devices say it of their own.

    Raises:
        BadInputError: a file that the bench file names cannot be used.
    """

    def __init__(
        self, file: BenchFile, frames: Mapping[str, FrameBlock], channels: Mapping[str, str]
    ) -> None:
        self._frames, self._clock = frames, _LogClock()
        self._wires = [LogWire(bus, self._clock) for bus in frames]
        self._loop = BusLoop(self._clock, list(self._wires))
        connections = connections_of(file, self._loop)
        self._devices: dict[str, Device] = {}
        self._file, self._channels = file, channels
        self.short = 0
        self.remarks: list[str] = []
        self.attachments: dict[str, bytes] = {"bench.toml": file.text.encode()}
        for key, table in file.device_tables.items():
            bus = getattr(table, "bus", None)
            if bus is None:
                self.remarks.append(f"{key} is not on a CAN bus, so a CAN log has no data of it")
            elif bus in frames:
                self._devices[key] = table.open(key.removeprefix("devices."), connections)
                self.attachments |= descriptions_of(key, table.files())

    def keys_of(self, file: str, channel: str) -> list[int]:
        """Identifiers by which a channel of a log is decoded: of the devices on the buses that it is."""
        buses = [bus for bus, name in self._channels.items() if name in (channel, f"{file}:{channel}")]
        return sorted({number for bus in buses for number in known_identifiers(self._file, bus)})

    def write(self, path: Path, began_ns: int) -> Recorder:
        """Decode all of it into a recording that is not closed yet.

        Raises:
            BadInputError: the frames that count the rows' samples are not among them.
            BenchError: the disk is full.
        """
        parts = list(self._decoded())
        given = {samples.stream for part in parts for samples in part}
        streams = [stream for stream in self._streams if _needed(stream, given)]
        counted = [_counting(stream) for stream in streams[:1]]
        if not given or not given.issuperset(counted):
            missing = counted[0] if counted else self._streams[0]
            raise BadInputError(
                f"the log has no {missing.label} of {missing.where}, which gives the time base",
                fix="give a log of that bus with all its frames, or decode by --dbc in place of --bench",
            )
        recorder = Recorder(path, streams, list(self._frames), TICK_S, clock_0_ns=began_ns)
        recorder.begin()
        base = streams[0]
        for number, part in enumerate(parts):
            for bus, block in self._frames.items():
                recorder.take_frames(bus, _between(block, number * _AT_ONCE_S, (number + 1) * _AT_ONCE_S))
            for samples in sorted(part, key=lambda samples: samples.stream is base):  # rows wait for all
                try:
                    recorder.take(samples)
                except (
                    BenchError
                ) as error:  # its clocks have parted: reported, the channels are as good as they are
                    self.remarks.append(f"{error.where}: {error.what}")
        return recorder

    @property
    def _sources(self) -> list[SampleSource]:
        return [source for device in self._devices.values() for source in device.sources]

    @property
    def _streams(self) -> list[Stream]:
        return [stream for source in self._sources for stream in source.streams]

    def _decoded(self) -> Iterator[list[Samples]]:
        """What the devices make of each stretch of the log."""
        end_s = max(float(block["time_s"][-1]) for block in self._frames.values())
        for number in range(math.floor(end_s / _AT_ONCE_S) + 1):
            self._clock.time_s = (number + 1) * _AT_ONCE_S
            for wire in self._wires:
                block = self._frames[wire.name]
                wire.shown = _between(block, number * _AT_ONCE_S, self._clock.time_s)
            self._loop.drain()
            yield [samples for source in self._sources for samples in source.samples()]


class _LogClock:
    """Time as far as the log has been shown."""

    virtual = True

    def __init__(self) -> None:
        self.time_s = 0.0

    def now_s(self) -> float:
        """Seconds since the log's first frame."""
        return self.time_s

    def sleep_until(self, time_s: float) -> None:
        """No one waits for what has been."""
        self.time_s = max(self.time_s, time_s)


def _counting(stream: Stream) -> Stream:
    """Whose frames count a stream's samples."""
    return (stream.counting.follows if stream.counting else None) or stream


def _needed(stream: Stream, given: set[Stream]) -> bool:
    """Whether it has samples, or those of one that has are counted by it."""
    followed = {other.counting.follows for other in given if other.counting}
    return stream in given or stream in followed


def _between(block: FrameBlock, start_s: float, end_s: float) -> FrameBlock:
    first, last = np.searchsorted(block["time_s"], (start_s, end_s))
    return block[first:last]
