"""Cyclic frames and packets of measured data, made for many samples at once, with times on the wire."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FRAME, FrameBlock, crc8_of, empty_block, longest_frame_s
from hil.core.can.signals import FrameLayout, payload_with
from hil.core.can.xcp import MOST_BYTES
from hil.core.channels import TICK_S
from hil.core.runtime.compiled import compiled
from sim_backend.rmcu import STAMP_BYTES, STAMP_TICK_S, DaqList, RmcuMemory

#: A frame with the column of a bench row that each of its signals shows.
Shown = tuple[FrameLayout, dict[str, int]]
COUNTER = "Counter"
_NO_CHECKSUM = -1


class EventSlots:
    """When frames that answer or announce something cross a bus: one by one, behind those of every sample.

    `begin_s` is how long the frames of every sample take, 0 until somebody says so.
    """

    def __init__(self, bit_rate: int) -> None:
        self.begin_s, self.bit_rate = 0.0, bit_rate
        self._last_s = 0.0

    def next_s(self, sample: int) -> float:
        """When the next frame of an event in a sample has crossed, in a later one where that is full."""
        frame_s = longest_frame_s(8, self.bit_rate)
        free_s = max(sample * TICK_S + self.begin_s, self._last_s)
        started = math.floor(free_s / TICK_S + 1e-9) * TICK_S
        if free_s < started + self.begin_s:  # the next sample's own frames come first
            free_s = started + self.begin_s
        if free_s + frame_s > started + TICK_S and self.begin_s + frame_s <= TICK_S:
            free_s = started + TICK_S + self.begin_s
        self._last_s = free_s + frame_s
        return self._last_s


class CyclicTraffic:
    """All frames that appear once a sample on one bus, in their order; `crc` frames end in a checksum."""

    def __init__(self, shown: list[Shown], bit_rate: int, crc: tuple[int, ...] = ()) -> None:
        layouts = [layout for layout, _ in shown]
        self._ends_s = np.cumsum([longest_frame_s(layout.length, bit_rate) for layout in layouts])
        still = np.zeros((1, len(shown)), FRAME)  # what is the same in every sample
        still["id"] = [layout.id for layout in layouts]
        still["length"] = [layout.length for layout in layouts]
        self._still = still.tobytes()
        self._checked = np.array([i if i in crc else _NO_CHECKSUM for i in still["id"][0].tolist()], np.int64)
        columns, places, numbers = [], [], []
        for message, (layout, signals) in enumerate(shown):
            for name, column in signals.items():
                signal = layout.signals[name]
                # A counter is not held at its end: its bits let it begin again.
                ends = (-np.inf, np.inf) if name == COUNTER else signal.counts
                columns.append((message, column))
                places.append(signal.place)
                numbers.append((signal.scale, signal.offset, *ends))
        self._columns = np.array(columns, np.int64).reshape(-1, 2)
        self._places = np.array(places, np.int64).reshape(-1, 5)
        self._numbers = np.array(numbers, float).reshape(-1, 4)

    @property
    def time_s(self) -> float:
        """How long the frames of one sample take on the wire."""
        return float(self._ends_s[-1])

    def block(self, rows: npt.NDArray[np.float64], first: int) -> FrameBlock:
        """Frames of sample `first` and those that follow it, in order of time; one row of the bench each."""
        block = np.frombuffer(bytearray(self._still * len(rows)), FRAME)
        _fill(
            rows, first, TICK_S, self._ends_s, self._checked, self._columns, self._places, self._numbers,
            block["time_s"].reshape(len(rows), -1), block["data"].reshape(len(rows), -1),
        )  # fmt: skip
        return block


@compiled
def _fill(rows, first, tick_s, ends_s, checked, columns, places, numbers, times_s, payloads):  # type: ignore[no-untyped-def]
    for i in range(rows.shape[0]):
        for message in range(ends_s.shape[0]):
            times_s[i, message] = (first + i) * tick_s + ends_s[message]
            payloads[i, message] = 0
        for entry in range(columns.shape[0]):
            message, column = columns[entry]
            scale, offset, low, high = numbers[entry]
            payloads[i, message] |= payload_with(rows[i, column], places[entry], scale, offset, low, high)
        for message in range(ends_s.shape[0]):
            if checked[message] != _NO_CHECKSUM:
                word = payloads[i, message]
                payloads[i, message] = word | crc8_of(checked[message], word) << np.uint64(56)


_STAMP_TURN = 1 << 8 * STAMP_BYTES


class DaqTraffic:
    """One running list.

    Args:
        begin_s: how long the frames of every sample that come before these take on their bus.

    Attributes:
        every: samples between two that are sent; more than the list wants if the bus has no room for them.
    """

    def __init__(
        self, daq: DaqList, memory: RmcuMemory, answer_id: int, bit_rate: int, begin_s: float
    ) -> None:
        self._memory, self._answer_id, self._stamped = memory, answer_id, daq.stamped
        head = 1 + STAMP_BYTES * daq.stamped
        self._lengths, packets, bytes_ = [], [], []
        for number, odt in enumerate(daq.odts):
            places = memory.places(odt)
            begin = head if number == 0 else 1
            self._lengths.append(begin + len(places))
            packets += [MOST_BYTES * number + begin + byte for byte in range(len(places))]
            bytes_ += places.tolist()
        self._to, self._from = np.array(packets, np.int64), np.array(bytes_, np.int64)
        self._numbers = daq.first + np.arange(len(daq.odts))
        frame_s = longest_frame_s(MOST_BYTES, bit_rate)
        each = max(1, math.floor((TICK_S - begin_s) / frame_s + 1e-9))
        place = np.arange(len(daq.odts))
        self._after_s = place // each * TICK_S + begin_s + (place % each + 1) * frame_s
        ticks = math.ceil(len(daq.odts) / each)
        self.every = math.ceil(ticks / daq.every) * daq.every
        self.overloaded = self.every > daq.every
        self.begin_s = begin_s + min(each, len(daq.odts)) * frame_s

    def block(self, rows: npt.NDArray[np.float64], first: int) -> FrameBlock:
        """Frames of sample `first` and those that follow it, in order of time; one row of the bench each."""
        samples = first + np.arange(len(rows))
        sent = samples % self.every == 0
        samples = samples[sent]
        if not len(samples):
            return empty_block()
        count = len(self._numbers)
        data = np.zeros((len(samples), MOST_BYTES * count), np.uint8)
        data[:, ::MOST_BYTES] = self._numbers
        if self._stamped:
            ticks = np.rint(samples * (TICK_S / STAMP_TICK_S)).astype(np.int64) % _STAMP_TURN
            data[:, 1 : 1 + STAMP_BYTES] = self._memory.stamps(ticks, STAMP_BYTES)
        data[:, self._to] = self._memory.images(rows[sent])[:, self._from]
        block = np.zeros((len(samples), count), FRAME)
        block["time_s"] = samples[:, None] * TICK_S + self._after_s
        block["id"], block["length"] = self._answer_id, self._lengths
        block["data"] = data.view("<u8")
        return block.reshape(-1)
