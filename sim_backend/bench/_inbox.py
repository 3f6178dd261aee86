"""What hosts have sent, until the sample before which a node takes it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class Sent(NamedTuple):
    """A host's frame: its payload as a little-endian number, and the sample that it comes before."""

    sample: int
    bus: str
    frame_id: int
    payload: int
    length: int

    @property
    def data(self) -> bytes:
        """Its payload."""
        return self.payload.to_bytes(8, "little")[: self.length]


class Inbox:
    """Frames in order of the samples that they come before; torque requests bind no batch of samples.

    Args:
        request: bus and identifier of torque requests, which a batch takes in its stride.
    """

    def __init__(self, request: tuple[str, int]) -> None:
        self._request = request
        self._sent: deque[Sent] = deque()
        self._breaks: deque[int] = deque()  # samples before which more comes than a torque request

    def put(self, sample: int, bus: str, frame_id: int, data: bytes) -> None:
        """A frame that comes before `sample`."""
        self.put_all([sample], bus, frame_id, [int.from_bytes(data, "little")], len(data))

    def put_all(self, samples: list[int], bus: str, frame_id: int, payloads: list[int], length: int) -> None:
        """Frames of one identifier, each before its sample, in order."""
        for sample, payload in zip(samples, payloads, strict=True):
            self._sent.append(Sent(sample, bus, frame_id, payload, length))
        if (bus, frame_id) != self._request:
            self._breaks.extend(samples)

    def until(self, sample: int) -> Iterator[Sent]:
        """What comes before `sample` or earlier, taken out one by one."""
        while self._sent and self._sent[0].sample <= sample:
            yield self._sent.popleft()
        while self._breaks and self._breaks[0] <= sample:
            self._breaks.popleft()

    def next_break(self, end: int) -> int:
        """The sample where a batch has to end: `end`, or where more comes than a torque request."""
        return min(end, self._breaks[0]) if self._breaks else end

    def requests_before(self, end: int) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.uint64]]:
        """The samples before which torque requests come, earlier than `end`, and these, taken out."""
        lines = []
        while self._sent and self._sent[0].sample < end:
            lines.append(self._sent.popleft())
        return np.array([c.sample for c in lines], np.int64), np.array([c.payload for c in lines], np.uint64)
