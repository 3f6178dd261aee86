"""Frames of CAN buses as a source of samples: each identifier is a stream."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from drivers.echoes import least_bytes
from drivers.samples import Counting, Samples, Stream
from hil.core.can.frames import ERROR_FRAME, EXTENDED, FrameBlock, crc8_of
from hil.core.can.signals import Signal, bits_at, number_at
from hil.core.runtime.compiled import compiled

_NONE_YET = -1
_OTHER_KINDS = EXTENDED | ERROR_FRAME  # an extended frame of the same number is another message
_SETTLED_S = 0.003  # frames older than this, before the newest of the slowest bus, have all arrived


@dataclass(frozen=True)
class Binding:
    """A signal of a frame on a bus that gives a channel."""

    bus: str
    frame_id: int
    signal: Signal
    channel: str


@dataclass(frozen=True)
class CountedBy:
    """The frame that counts the samples of all bound frames on its bus.

    `counter` is its counter, an unsigned whole number that takes every value of its bits; None: the frame
    comes once a sample and is counted. `opens`: it is the first of its sample on the bus, else the last.
    """

    bus: str
    frame_id: int
    name: str
    counter: Signal | None = None
    opens: bool = False


class FrameSource:
    """Decodes the bound signals of every frame, in blocks, and counts.

    The streams are in the order in which the bindings name their frames first; a frame that only counts is
    the last, without channels. Frames of a bus without `counted_by` have the times at which they came.
    `checked` are frames by identifier with the signal of their checksum (`hil.core.can.frames`, byte 7):
    one whose checksum is not that of its content is left out.
    """

    def __init__(
        self,
        bindings: Sequence[Binding],
        period_s: float,
        counted_by: CountedBy | None = None,
        checked: Mapping[int, Signal] | None = None,
    ) -> None:
        frames = list(dict.fromkeys((b.bus, b.frame_id) for b in bindings))
        if counted_by and (counted_by.bus, counted_by.frame_id) not in frames:
            frames.append((counted_by.bus, counted_by.frame_id))
        bound = [[b for b in bindings if (b.bus, b.frame_id) == frame] for frame in frames]
        self.streams = _streams(frames, bound, period_s, counted_by)
        self._decoders = {
            bus: _Decoder(
                [
                    (stream, frame_id, signals)
                    for stream, (its_bus, frame_id), signals in zip(self.streams, frames, bound, strict=True)
                    if its_bus == bus
                ],
                counted_by if counted_by and counted_by.bus == bus else None,
                checked or {},
            )
            for bus, _ in frames
        }
        self._waiting: list[Samples] = []

    def take(self, bus: str, block: FrameBlock) -> None:
        """Take the frames of one bus."""
        if bus in self._decoders:
            self._waiting += self._decoders[bus].decode(block)

    def samples(self) -> list[Samples]:
        """What has come since the last call."""
        waiting, self._waiting = self._waiting, []
        return waiting


def _streams(
    frames: list[tuple[str, int]], bound: list[list[Binding]], period_s: float, counted_by: CountedBy | None
) -> tuple[Stream, ...]:
    counting: Stream | None = None
    if counted_by:
        place = frames.index((counted_by.bus, counted_by.frame_id))
        counter = counted_by.counter
        by = f"{counter.length} bits in {counted_by.name}" if counter else f"{counted_by.name} frames"
        own = Counting(by, 1 << counter.length if counter else 1)
        counting = _stream(frames[place], bound[place], period_s, own, counted_by.name)
    found = []
    for frame, signals in zip(frames, bound, strict=True):
        if counting is None or counted_by is None or frame[0] != counted_by.bus:
            found.append(_stream(frame, signals, period_s, None))
        elif frame[1] == counted_by.frame_id:
            found.append(counting)
        else:
            by = counting.counting.by if counting.counting else ""
            found.append(
                _stream(frame, signals, period_s, Counting(by, follows=counting, opens=counted_by.opens))
            )
    return tuple(found)


def _stream(
    frame: tuple[str, int], bound: list[Binding], period_s: float, counting: Counting | None, name: str = ""
) -> Stream:
    bus, frame_id = frame
    return Stream(
        label=f"frame 0x{frame_id:03X} ({bound[0].channel if bound else name})",
        where=f"bus '{bus}'",
        channels=tuple(b.channel for b in bound),
        units=tuple(b.signal.unit for b in bound),
        period_s=period_s,
        late_s=_SETTLED_S,
        counting=counting,
    )


class _Decoder:
    """The bound signals of one bus, and its count."""

    def __init__(
        self,
        bound: list[tuple[Stream, int, list[Binding]]],
        counted_by: CountedBy | None,
        checked: Mapping[int, Signal],
    ) -> None:
        self._streams = [stream for stream, _, _ in bound]
        self._counted = counted_by is not None
        signals = [b.signal for _, _, bindings in bound for b in bindings]
        ends = np.cumsum([len(bindings) for _, _, bindings in bound]).tolist()
        self._columns = [slice(first, end) for first, end in zip([0, *ends], ends, strict=False)]
        self._ends = np.array(ends, np.int64)
        self._ids = np.array([frame_id for _, frame_id, _ in bound], np.int64)
        read = [[b.signal for b in bindings] for _, _, bindings in bound]
        self._places = np.array([s.place for s in signals], np.int64).reshape(-1, 5)
        self._scales = np.array([(s.scale, s.offset) for s in signals]).reshape(-1, 2)
        self._counter = np.full(6, -1, np.int64)  # which stream counts, -1: none; and where its counter lies
        if counted_by:
            self._counter[0] = self._ids.tolist().index(counted_by.frame_id)
            if counted_by.counter:
                self._counter[1:] = counted_by.counter.place
                read[self._counter[0]].append(counted_by.counter)
        for place, (_, frame_id, _) in enumerate(bound):
            read[place] += [checked[frame_id]] if frame_id in checked else []
        self._checked = np.array([frame_id in checked for _, frame_id, _ in bound], bool)
        self._least = np.array([least_bytes(several) for several in read], np.int64)
        self._state = np.array([_NONE_YET, 0, 0], np.int64)

    def decode(self, block: FrameBlock) -> list[Samples]:
        """Samples of each stream that the block has frames of."""
        streams, frames = len(self._ids), len(block)
        counts = np.zeros(streams, np.int64)
        times = np.empty((streams, frames))
        numbers = np.empty((len(self._places), frames))
        marks = np.empty((streams if self._counted else 0, frames), np.int64)
        _read(
            block["id"], block["flags"], block["length"], block["time_s"], block["data"],
            self._ids, self._checked, self._least, self._ends,
            self._places, self._scales, self._counter, self._state,
            counts, times, numbers, marks,
        )  # fmt: skip
        values = numbers.T
        found = []
        for index, count in enumerate(counts.tolist()):
            if count:
                marked = marks[index, :count] if self._counted else None
                columns = self._columns[index]
                found.append(
                    Samples(self._streams[index], times[index, :count], values[:count, columns], marked)
                )
        return found


@compiled
def _count(payload, counter, state):  # type: ignore[no-untyped-def]
    """The count of a frame that counts, without turns; -1 if it is only a copy of the one before.

    State: the newest count, frames of others since, and whether others ever came.
    """
    newest, others, ever = state
    state[1] = 0
    if counter[2] < 1:  # frames are counted; two with nothing between them are one that was sent again
        if newest >= 0 and others == 0 and ever:
            return -1
        state[0] = max(newest, -1) + 1
        return state[0]
    turn = np.int64(1) << counter[2]
    raw = bits_at(payload, counter[1:])
    if newest < 0:
        state[0] = raw + turn  # what was overtaken by the first is no less than 0
        return state[0]
    ahead = (raw - newest) % turn
    if ahead > 3 * turn // 4:  # overtaken: less likely than many lost
        ahead -= turn
    state[0] = max(newest, newest + ahead)
    return newest + ahead


@compiled
def _read(  # type: ignore[no-untyped-def]
    ids,
    flags,
    lengths,
    stamps,
    payloads,
    wanted,
    checked,
    least,
    ends,
    places,
    scales,
    counter,
    state,
    counts,
    times,
    values,
    marks,
):
    """Sort frames by identifier, count, and read their signals, rounded as `Signal.decode` does."""
    for frame in range(ids.shape[0]):
        if flags[frame] & _OTHER_KINDS:
            continue
        for stream in range(wanted.shape[0]):
            if ids[frame] != wanted[stream] or lengths[frame] < least[stream]:
                continue
            if checked[stream] and payloads[frame] >> np.uint64(56) != crc8_of(ids[frame], payloads[frame]):
                continue
            at = counts[stream]
            if counter[0] == stream:
                mark = _count(payloads[frame], counter, state)
                if mark < 0:
                    continue
                marks[stream, at] = mark
            elif counter[0] >= 0:
                state[1] += 1
                state[2] = 1
                marks[stream, at] = state[0]
            counts[stream] = at + 1
            times[stream, at] = stamps[frame]
            for entry in range(ends[stream - 1] if stream else 0, ends[stream]):
                number = number_at(payloads[frame], places[entry])
                values[entry, at] = number * scales[entry, 0] + scales[entry, 1]
