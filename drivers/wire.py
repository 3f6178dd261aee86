"""A CAN bus as the drivers see it: send a frame, take all that has come, keep both for the recording."""

from __future__ import annotations

from typing import Any

import can
import numpy as np

from hil.core.clock import Clock
from hil.core.errors import BenchError
from hil.core.frames import ERROR_FRAME, EXTENDED, FRAME, SENT_BY_HOST, FrameBlock, empty_block, joined


class Wire:
    """One bus, used from one thread, without a receive thread that could die unseen.

    A bus that has a `recv_block` of its own (see `hil.core.frames`) is drained with it, any other message
    by message; a bus that has `send_frame(id, data)` is given no message object. The result is the same.
    """

    def __init__(self, name: str, bus: can.BusABC, clock: Clock, *, epoch_offset_s: float = 0.0) -> None:
        self.name = name
        self._bus = bus
        self._clock = clock
        self._epoch_offset_s = epoch_offset_s  # message time stamps minus clock time
        self._sent: list[tuple[float, int, int, int, int]] = []
        self._take: Any = getattr(bus, "recv_block", None)
        self._put: Any = getattr(bus, "send_frame", self._put_message)

    def send(self, frame_id: int, data: bytes) -> None:
        """Put one standard data frame on the bus.

        Raises:
            BenchError: the bus does not take it (unplugged, down, bus-off, queue full).
        """
        try:
            self._put(frame_id, data)
        except (can.CanError, OSError) as error:
            raise self._failed("sending", error) from error
        self._sent.append(
            (self._clock.now_s(), frame_id, SENT_BY_HOST, len(data), int.from_bytes(data, "little"))
        )

    def drain(self) -> FrameBlock:
        """Every frame that came since the last call, and those sent, in order of time."""
        try:
            block: FrameBlock = self._take() if self._take is not None else self._take_one_by_one()
        except (can.CanError, OSError) as error:
            raise self._failed("receiving", error) from error
        if self._sent:
            sent = np.array(self._sent, FRAME)
            self._sent = []
            if not len(block):
                return sent
            block = joined([sent, block])
            block = block[np.argsort(block["time_s"], kind="stable")]
        return block

    def close(self) -> None:
        """Leave the bus."""
        self._bus.shutdown()

    def _put_message(self, frame_id: int, data: bytes) -> None:
        self._bus.send(can.Message(arbitration_id=frame_id, data=data, is_extended_id=False, check=False))

    def _take_one_by_one(self) -> FrameBlock:
        frames = []
        while (message := self._bus.recv(0)) is not None:
            flags = EXTENDED * message.is_extended_id | ERROR_FRAME * message.is_error_frame
            payload = int.from_bytes(message.data, "little")
            stamp = message.timestamp - self._epoch_offset_s
            frames.append((stamp, message.arbitration_id, flags, len(message.data), payload))
        return np.array(frames, FRAME) if frames else empty_block()

    def _failed(self, doing: str, error: Exception) -> BenchError:
        return BenchError(
            f"{doing} failed: {error}",
            where=f"bus '{self.name}'",
            fix="check the CAN adapter, its cable and its bit rate",
        )
