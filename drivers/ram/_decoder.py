"""From packets of measured data to samples: whole ones only, with the counts that their time stamps give.

Symbols are laid into ODTs, the packets of one moment. How many samples never came is counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from drivers.samples import Array, Numbers, Samples, Stream
from hil.core.can.frames import FrameBlock, empty_block, joined, most_frame_bits
from hil.core.can.symbols import Symbol
from hil.core.can.xcp import LARGEST_ODT_NUMBER, MOST_BYTES, TimeStamps
from hil.core.errors import BenchError

_NUMBER_BYTES = 1


@dataclass(frozen=True)
class Entry:
    """Bytes of memory that stand together in an ODT."""

    address: int
    extension: int
    size: int


Odt = tuple[Entry, ...]


def packed(
    symbols: Sequence[Symbol], stamp_bytes: int, packet_bytes: int, granularity: int, most_in_entry: int
) -> list[Odt]:
    """The symbols byte behind byte, in as few packets as hold them; one may end in the next packet.

    Args:
        stamp_bytes: of the time stamp, which stands in the first packet.
        packet_bytes: of a packet, the ODT's number included.
        granularity: bytes of which the size of an entry is a multiple.
        most_in_entry: bytes of the largest entry.

    Raises:
        BenchError: a symbol whose size is no multiple, or more packets than there are numbers.
    """
    odts: list[list[Entry]] = [[]]
    room = packet_bytes - _NUMBER_BYTES - stamp_bytes
    for symbol in symbols:
        if symbol.size % granularity:
            raise BenchError(
                f"symbol '{symbol.name}' has {symbol.size} bytes; only multiples of {granularity} go"
            )
        address, left = symbol.address, symbol.size
        while left:
            size = min(left, room, most_in_entry) // granularity * granularity
            if not size:
                if not odts[-1] and len(odts) > 1:
                    raise BenchError(f"packets of {packet_bytes} bytes have no room for {granularity} bytes")
                odts.append([])
                room = packet_bytes - _NUMBER_BYTES
                continue
            odts[-1].append(Entry(address, symbol.extension, size))
            address, left, room = address + size, left - size, room - size
    if len(odts) > LARGEST_ODT_NUMBER:
        raise BenchError(f"{len(odts)} packets are needed for each sample; omit symbols")
    return [tuple(odt) for odt in odts]


def bits_of(odts: Sequence[Odt], stamp_bytes: int) -> int:
    """Bits that the packets of one moment take on a CAN bus, with as many stuff bits as there may be."""
    sizes = [_NUMBER_BYTES + sum(entry.size for entry in odt) for odt in odts]
    sizes[0] += stamp_bytes
    return sum(int(most_frame_bits(size, False)) for size in sizes)


_LOOK_S, _LEAST_SAMPLES = 0.5, 20


class Measured:
    """A `SampleSource`; `lost`: the share of samples that never came, over the last half second or so."""

    def __init__(self, stream: Stream) -> None:
        self.streams = (stream,)
        self._look_s = max(_LOOK_S, _LEAST_SAMPLES * stream.period_s)
        self._waiting: list[Samples] = []
        self.begin(0.0)

    @property
    def came(self) -> bool:
        """Whether anything came since `begin`."""
        return self._newest is not None

    def begin(self, now_s: float) -> None:
        """Forget what came until now, and count from here."""
        self._waiting.clear()
        self.lost = 0.0
        self._since_s, self._came = now_s, 0
        self._first: int | None = None
        self._newest: int | None = None

    def take(self, samples: Samples, now_s: float) -> None:
        """Samples with counts have come."""
        if samples.counts is None or not len(samples.counts):
            return
        self._waiting.append(samples)
        if self._first is None:
            self._first = int(samples.counts[0]) - 1
        self._newest = max(self._newest or self._first, int(samples.counts.max()))
        self._came += len(samples.counts)
        if now_s - self._since_s >= self._look_s:
            wanted = self._newest - self._first
            self.lost = max(0.0, 1.0 - self._came / wanted) if wanted > 0 else 0.0
            self._since_s, self._first, self._came = now_s, self._newest, 0

    def samples(self) -> list[Samples]:
        """What has come since the last call."""
        waiting, self._waiting = self._waiting, []
        return waiting


_STANDS_STILL = 50  # samples


class DaqDecoder:
    """Reads the packets of one DAQ list.

    Args:
        first: number of its first ODT.
        odts: what stands in them, in the order of `symbols`.
        order: "<" or ">", as the slave counts.
        period_s: distance of samples.

    Attributes:
        stands_still: whether the time stamps do not change any more.
    """

    def __init__(
        self,
        first: int,
        odts: Sequence[Odt],
        symbols: Sequence[Symbol],
        stamps: TimeStamps,
        order: str,
        period_s: float,
    ) -> None:
        self._symbols, self._order = symbols, order
        self._ticks_each = period_s / stamps.tick_s
        self._stamp = np.dtype(f"{order}u{stamps.size}")
        self._turn = 1 << 8 * stamps.size
        self._numbers = first + np.arange(len(odts))
        sizes = np.array([_NUMBER_BYTES + sum(entry.size for entry in odt) for odt in odts])
        sizes[0] += stamps.size
        self._lengths = sizes
        # Where in the packets of a sample, 8 bytes each, the symbols' bytes lie, one behind the other
        begins = np.full(len(odts), _NUMBER_BYTES)
        begins[0] += stamps.size
        self._bytes = np.concatenate(
            [
                np.arange(MOST_BYTES * odt + begin, MOST_BYTES * odt + end)
                for odt, (begin, end) in enumerate(zip(begins, sizes, strict=True))
            ]
        )
        self._stamp_bytes = slice(_NUMBER_BYTES, _NUMBER_BYTES + stamps.size)
        self._ends = np.cumsum([symbol.size for symbol in symbols]).tolist()
        self._rest: FrameBlock = empty_block()
        self._newest: int | None = None
        self._same = 0

    @property
    def stands_still(self) -> bool:
        """Whether the time stamps do not change any more, though samples come."""
        return self._same >= _STANDS_STILL

    def take(self, block: FrameBlock) -> tuple[Array, Array, Numbers]:
        """Arrival (s) of each whole sample, values (n, symbols), and counts without turns."""
        frames, places = self._whole(joined([self._rest, block]) if len(self._rest) else block)
        chosen = frames[places]
        packets = np.ascontiguousarray(chosen["data"].astype("<u8")).view(np.uint8)
        packets = packets.reshape(len(places), MOST_BYTES * len(self._numbers))
        memory = packets[:, self._bytes]
        values = np.empty((len(places), len(self._symbols)))
        for column, (symbol, end) in enumerate(zip(self._symbols, self._ends, strict=True)):
            values[:, column] = symbol.values(memory[:, end - symbol.size : end], self._order)
        stamps = np.ascontiguousarray(packets[:, self._stamp_bytes]).view(self._stamp)[:, 0]
        return chosen["time_s"][:, 0].copy(), values, self._counts(stamps.astype(np.int64))

    def _whole(self, frames: FrameBlock) -> tuple[FrameBlock, npt.NDArray[np.intp]]:
        """Places of the packets of each whole sample; what may yet become one waits for the next block."""
        count = len(self._numbers)
        if count > 1:  # a frame that an adapter gives twice
            again = (frames["data"][1:] == frames["data"][:-1]) & (
                frames["length"][1:] == frames["length"][:-1]
            )
            if np.any(again):
                frames = frames[np.concatenate([[True], ~again])]
        numbers = (frames["data"] & np.uint64(0xFF)).astype(np.int64)
        starts = np.flatnonzero(numbers == self._numbers[0])
        later = starts[starts + count > len(frames)]
        self._rest = frames[later[-1] :].copy() if len(later) else empty_block()
        places = starts[starts + count <= len(frames)][:, None] + np.arange(count)
        good = np.all(numbers[places] == self._numbers, axis=1)
        good &= np.all(frames["length"][places] >= self._lengths, axis=1)
        return frames, places[good]

    def _counts(self, stamps: Numbers) -> Numbers:
        """Counts of the slave's periods; a stamp goes back by at most a quarter of its turn."""
        if not len(stamps):
            return stamps
        before = stamps[0] if self._newest is None else self._newest
        steps = np.diff(stamps, prepend=before % self._turn) % self._turn
        steps[steps > 3 * self._turn // 4] -= self._turn
        ticks = before + np.cumsum(steps)
        moved = np.flatnonzero(steps)
        self._same = len(steps) - 1 - int(moved[-1]) if len(moved) else self._same + len(steps)
        self._newest = int(ticks[-1])
        return np.rint(ticks / self._ticks_each).astype(np.int64)
