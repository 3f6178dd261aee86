"""Frames of CAN buses as a source of samples: each identifier is a stream."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drivers.samples import Samples, Stream
from hil.core.compiled import compiled
from hil.core.frames import FrameBlock, standard
from hil.core.signals import Signal, double_of, single_of, swapped

_SETTLED_S = 0.003  # frames older than this, before the newest of the slowest bus, have all arrived


@dataclass(frozen=True)
class Binding:
    """A signal of a frame on a bus that gives a channel."""

    bus: str
    frame_id: int
    signal: Signal
    channel: str


class FrameSource:
    """Decodes the bound signals of every frame, in blocks.

    The streams are in the order in which the bindings name their frames first.
    """

    def __init__(self, bindings: Sequence[Binding], period_s: float) -> None:
        frames = list(dict.fromkeys((b.bus, b.frame_id) for b in bindings))
        bound = [[b for b in bindings if (b.bus, b.frame_id) == frame] for frame in frames]
        self.streams = tuple(_stream(signals, period_s) for signals in bound)
        self._decoders = {
            bus: _Decoder(
                [(s, b) for s, b in zip(self.streams, bound, strict=True) if b[0].bus == bus],
            )
            for bus, _ in frames
        }
        self._waiting: list[Samples] = []

    def take(self, bus: str, block: FrameBlock) -> None:
        """Take the frames of one bus."""
        if bus in self._decoders:
            self._waiting += self._decoders[bus].decode(standard(block))

    def samples(self) -> list[Samples]:
        """What has come since the last call."""
        waiting, self._waiting = self._waiting, []
        return waiting


def _stream(bound: list[Binding], period_s: float) -> Stream:
    first = bound[0]
    return Stream(
        label=f"frame 0x{first.frame_id:03X} ({first.channel})",
        where=f"bus '{first.bus}'",
        channels=tuple(b.channel for b in bound),
        units=tuple(b.signal.unit for b in bound),
        period_s=period_s,
        late_s=_SETTLED_S,
    )


class _Decoder:
    """The bound signals of one bus."""

    def __init__(self, bound: list[tuple[Stream, list[Binding]]]) -> None:
        self._streams = [stream for stream, _ in bound]
        signals = [b.signal for _, bindings in bound for b in bindings]
        self._ends = np.cumsum([len(bindings) for _, bindings in bound])
        self._ids = np.array([bindings[0].frame_id for _, bindings in bound], np.int64)
        self._places = np.array(
            [(s.shift, s.length, s.signed, s.big_endian, s.is_float) for s in signals], np.int64
        )
        self._scales = np.array([[s.scale] for s in signals])
        self._offsets = np.array([[s.offset] for s in signals])

    def decode(self, block: FrameBlock) -> list[Samples]:
        """Samples of each stream that the block has frames of."""
        counts = np.zeros(len(self._ids), np.int64)
        times = np.empty((len(self._ids), len(block)))
        numbers = np.zeros((len(self._places), len(block)))
        _read(
            block["id"], block["time_s"], block["data"], self._ids, self._ends, self._places,
            counts, times, numbers,
        )  # fmt: skip
        # Scaled here and not in the compiled part, which may round differently from `Signal.decode`.
        values = (numbers * self._scales + self._offsets).T
        found, first = [], 0
        for index, stream in enumerate(self._streams):
            count, end = int(counts[index]), int(self._ends[index])
            if count:
                found.append(Samples(stream, times[index, :count], values[:count, first:end]))
            first = end
        return found


@compiled
def _read(ids, stamps, payloads, wanted, ends, places, counts, times, numbers):  # type: ignore[no-untyped-def]
    """Sort frames by identifier and read the numbers in their signals, unscaled."""
    for frame in range(ids.shape[0]):
        for stream in range(wanted.shape[0]):
            if ids[frame] != wanted[stream]:
                continue
            at = counts[stream]
            counts[stream] = at + 1
            times[stream, at] = stamps[frame]
            for entry in range(ends[stream - 1] if stream else 0, ends[stream]):
                shift, length, signed, big_endian, is_float = places[entry]
                word = payloads[frame]
                if big_endian:
                    word = swapped(word)
                bits = (word >> np.uint64(shift)) & (~np.uint64(0) >> np.uint64(64 - length))
                if is_float:
                    numbers[entry, at] = single_of(bits) if length == 32 else double_of(bits)
                else:
                    raw = np.int64(bits)
                    if signed and raw >> (length - 1):
                        raw -= 1 << length
                    numbers[entry, at] = np.float64(raw)
