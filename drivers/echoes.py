"""Own frames that come back from the bus: when each request was really seen there."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from hil.core.can.frames import SENT_BY_HOST, FrameBlock

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
