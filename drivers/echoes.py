"""What a block of frames says of single ones: own echoes, and the newest of each identifier."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock
from hil.core.can.signals import Signal
from hil.core.runtime.compiled import compiled

_OTHERS = SENT_BY_HOST | EXTENDED | ERROR_FRAME


def least_bytes(signals: Iterable[Signal]) -> int:
    """How many bytes a frame must have for all of these signals to be in it: half a frame says nothing."""
    return max((_bytes_of(signal) for signal in signals), default=0)


def _bytes_of(signal: Signal) -> int:
    return 8 - signal.shift // 8 if signal.big_endian else -(-(signal.shift + signal.length) // 8)


class NewestFrames:
    """Looks for the last received frame of each kind that is whole.

    Args:
        signals: those read of a frame, by its identifier.
    """

    def __init__(self, signals: Mapping[int, Iterable[Signal]]) -> None:
        self._ids = np.array(list(signals), np.int64)
        self._least = np.array([least_bytes(several) for several in signals.values()], np.int64)
        self._places = np.zeros(len(signals), np.int64)
        self._times_s = np.zeros(len(signals))
        self._payloads = np.zeros(len(signals), np.uint64)

    def of(self, block: FrameBlock) -> list[tuple[float, int] | None]:
        """Time and payload for each identifier, in the order in which they were given; None without one."""
        # Compiled code fills arrays that are there: making some to give back takes it longer than the search.
        _last(block, self._ids, self._least, self._places, self._times_s, self._payloads)
        every = zip(self._places.tolist(), self._times_s.tolist(), self._payloads.tolist(), strict=True)
        return [(time_s, payload) if place >= 0 else None for place, time_s, payload in every]


@compiled
def _last(block, wanted, least, places, times_s, payloads):  # type: ignore[no-untyped-def]
    for entry in range(wanted.shape[0]):
        places[entry] = -1
        for place in range(block.shape[0] - 1, -1, -1):
            frame = block[place]
            if frame.id != wanted[entry] or frame.length < least[entry] or frame.flags & _OTHERS:
                continue
            places[entry], times_s[entry], payloads[entry] = place, frame.time_s, frame.data
            break


_MOST = 4096  # frames; who fetches none for seconds wants none


class Echo(NamedTuple):
    """An own frame as the bus showed it: time on the bench clock in s, identifier, payload (see FRAME)."""

    time_s: float
    frame_id: int
    payload: int


class Echoes:
    """Tells own frames that come back from those of others, and keeps them until they are fetched.

    SocketCAN marks every frame of a process of this machine, and a simulated bench may be one: an echo is
    what was sent and has not come back yet. Bounded: what no one fetches is forgotten.
    """

    def __init__(self) -> None:
        self._awaited: deque[tuple[int, int]] = deque(maxlen=_MOST)
        self._seen: deque[Echo] = deque(maxlen=_MOST)

    def expect(self, frame_id: int, payload: int) -> None:
        """A frame has been sent."""
        self._awaited.append((frame_id, payload))

    def take(self, time_s: float, frame_id: int, payload: int) -> bool:
        """Whether a frame of this machine is an own one; then it is kept here and is no received frame."""
        if (frame_id, payload) not in self._awaited:
            return False
        while self._awaited.popleft() != (frame_id, payload):
            pass  # its echo was lost
        self._seen.append(Echo(time_s, frame_id, payload))
        return True

    def others(self, block: FrameBlock) -> FrameBlock:
        """A block of received frames without the own ones in it."""
        own = block["flags"] == SENT_BY_HOST
        if not own.any():
            return block
        for frame in block[own]:
            self.take(float(frame["time_s"]), int(frame["id"]), int(frame["data"]))
        others: FrameBlock = block[~own]
        return others

    def fetch(self) -> list[Echo]:
        """What was seen since the last call, in the order in which it was sent."""
        seen = list(self._seen)
        self._seen.clear()
        return seen
