"""Packets in which the emulated RMCU sends what a master has it measure, for many samples at once."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.can.frames import FRAME, FrameBlock, empty_block, longest_frame_s
from hil.core.can.xcp import MOST_BYTES
from hil.core.channels import TICK_S
from sim_backend.rmcu import STAMP_BYTES, STAMP_TICK_S, DaqList, RmcuMemory

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
