"""Samples of a device: what it measures, how often, and how they reach those who record and watch."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Counting:
    """What tells the number of each sample of a stream.

    Attributes:
        by: in words, for reports: "8 bits in frame 0x111", "SYNC frames".
        turn: how many values the counter takes before it begins again; 1: there is none, frames are counted.
        follows: the stream whose frames count this one's samples too; None: its own do.
        opens: with `follows`: whether its frame is the first of each sample, else the last.
    """

    by: str
    turn: int = 1
    follows: Stream | None = None
    opens: bool = False


@dataclass(frozen=True, eq=False)
class Stream:
    """Channels that a device samples together.

    Attributes:
        label: what comes, for messages: "frame 0x110 (motor_speed_rad_s)", "readings".
        where: from where, for messages: "bus 'rmcu'", "device 'oil'".
        channels: their names in a recording; SI, with the unit in the name.
        units: of each channel, for messages.
        period_s: distance of samples, seconds.
        silence_s: without a sample for longer than this the device is taken for dead (a bench fault).
        late_s: by how much a sample's time may lie before the moment at which it is handed out.
        counting: what counts its samples; None: their times are the device's word.
    """

    label: str
    where: str
    channels: tuple[str, ...]
    units: tuple[str, ...]
    period_s: float
    silence_s: float = 0.1
    late_s: float = 0.02
    counting: Counting | None = None


class Samples(NamedTuple):
    """Some samples of a stream, in the order in which they came.

    `time_s`: shape (n,), seconds of the bench clock: when they were taken, or for a counted stream when they
    arrived; `values`: shape (n, channels), NaN where the device does not know. `counts`, of a counted stream,
    shape (n,): the count without turns; of one that follows another the newest count that had come before.
    """

    stream: Stream
    time_s: Array
    values: Array
    counts: Numbers | None = None


class SampleSource(Protocol):
    """Whatever gives samples: frames of a bus, lines of a serial port, memory that is polled."""

    @property
    def streams(self) -> Sequence[Stream]:
        """What it gives; does not change while the bench is open."""
        ...

    def samples(self) -> Iterable[Samples]:
        """What has come since the last call; never waits."""
        ...


class SampleQueue:
    """A source for devices that make their samples one by one: put in here, handed out once."""

    def __init__(self, *streams: Stream) -> None:
        self.streams = streams
        self._waiting: list[Samples] = []

    def put(self, stream: Stream, time_s: float, *values: float) -> None:
        """Add one sample: its time on the bench clock in seconds, a value for each channel."""
        self._waiting.append(Samples(stream, np.array([time_s]), np.array([values], float)))

    def samples(self) -> list[Samples]:
        """What has come since the last call."""
        waiting, self._waiting = self._waiting, []
        return waiting
