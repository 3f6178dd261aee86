"""The cyclic frames of a bus, made for many samples at once, with the times they take on the wire."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.checksum import crc8_many
from hil.core.compiled import compiled
from hil.core.frames import FRAME, FrameBlock
from hil.core.signals import FrameLayout, Signal

#: A frame with the column of a bench row that each of its signals shows.
Shown = tuple[FrameLayout, dict[str, int]]
COUNTER = "Counter"


def frame_time_s(length: int, bit_rate: int) -> float:
    """Longest time of a standard data frame on the bus, stuff bits included (ISO 11898-1)."""
    bits = 8 * length
    return (bits + 47 + (34 + bits - 1) // 4) / bit_rate


class CyclicTraffic:
    """All frames that appear once a sample on one bus, in their order; `crc` frames end in a checksum."""

    def __init__(self, shown: list[Shown], bit_rate: int, crc: tuple[int, ...] = ()) -> None:
        self._layouts = [layout for layout, _ in shown]
        self._crc = [column for column, layout in enumerate(self._layouts) if layout.id in crc]
        self._ends_s = np.cumsum([frame_time_s(layout.length, bit_rate) for layout in self._layouts])
        self._still = np.zeros(len(shown), FRAME)  # what is the same in every sample
        self._still["id"] = [layout.id for layout in self._layouts]
        self._still["length"] = [layout.length for layout in self._layouts]
        places, numbers = [], []
        self._others: list[tuple[int, int, Signal]] = []  # signals that the compiled loop does not know
        for message, (layout, columns) in enumerate(shown):
            for name, column in columns.items():
                signal = layout.signals[name]
                if signal.is_float or signal.big_endian:
                    self._others.append((message, column, signal))
                    continue
                low = -(1 << (signal.length - 1)) if signal.signed else 0
                # A counter is not held at its end: its bits let it begin again.
                ends = (-np.inf, np.inf) if name == COUNTER else (low, low + (1 << signal.length) - 1)
                places.append((message, column, signal.shift, signal.length))
                # A counter is not held at its end: its bits let it begin again.
                numbers.append(
                    (signal.scale, signal.offset, *((-np.inf, np.inf) if name == COUNTER else ends))
                )
        self._places = np.array(places, np.int64).reshape(-1, 4)
        self._numbers = np.array(numbers, float).reshape(-1, 4)

    @property
    def time_s(self) -> float:
        """How long the frames of one sample take on the wire."""
        return float(self._ends_s[-1])

    def block(self, rows: npt.NDArray[np.float64], start_s: npt.NDArray[np.float64]) -> FrameBlock:
        """Frames of the samples that began at `start_s`, in order of time."""
        block = np.empty((len(rows), len(self._layouts)), FRAME)
        block[:] = self._still
        block["time_s"] = start_s[:, None] + self._ends_s
        payloads = np.zeros((len(rows), len(self._layouts)), np.uint64)
        _fill(rows, self._places, self._numbers, payloads)
        for message, column, signal in self._others:
            values = rows[:, column] % (1 << signal.length) if signal.name == COUNTER else rows[:, column]
            payloads[:, message] |= signal.encode(values)
        for column in self._crc:
            payloads[:, column] |= crc8_many(self._layouts[column].id, payloads[:, column]) << np.uint64(56)
        block["data"] = payloads
        return block.reshape(-1)


@compiled
def _fill(rows, places, numbers, payloads):  # type: ignore[no-untyped-def]
    for entry in range(places.shape[0]):
        message, column, shift, length = places[entry]
        scale, offset, low, high = numbers[entry]
        mask = ~np.uint64(0) >> np.uint64(64 - length)
        for i in range(rows.shape[0]):
            count = min(max(np.rint((rows[i, column] - offset) / scale), low), high)
            payloads[i, message] |= (np.uint64(np.int64(count)) & mask) << np.uint64(shift)


def single(frame_id: int, data: bytes, time_s: float) -> FrameBlock:
    """A block of one frame."""
    block = np.zeros(1, FRAME)
    block["time_s"], block["id"], block["length"] = time_s, frame_id, len(data)
    block["data"] = int.from_bytes(data, "little")
    return block
