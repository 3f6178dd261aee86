"""Buses that are only listened to: a live one, and one of which only a log is left."""

from __future__ import annotations

from typing import cast

import can

from drivers.wire import Wire
from hil.core.can.frames import FrameBlock, empty_block
from hil.core.errors import BenchError
from hil.core.runtime.clock import Clock


class ListeningWire(Wire):
    """A `Wire` that sends nothing, whoever asks it to."""

    def send(self, frame_id: int, data: bytes) -> None:
        """Raises:
        BenchError: always.
        """
        del data
        what = f"0x{frame_id:03X} was to be sent on a bus that is only listened to"
        raise BenchError(what, where=f"bus '{self.name}'")


class LogWire(ListeningWire):
    """A `Wire` whose next block is what was put into `shown`."""

    def __init__(self, name: str, clock: Clock) -> None:
        super().__init__(name, cast(can.BusABC, object()), clock)
        self.shown = empty_block()

    def drain(self) -> FrameBlock:
        """What was shown since the last call."""
        block, self.shown = self.shown, empty_block()
        return block
