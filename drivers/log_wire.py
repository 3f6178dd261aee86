"""A bus of which only a log is left: frames come when they are shown, and nothing can be sent."""

from __future__ import annotations

from typing import cast

import can

from drivers.listening_wire import ListeningWire
from hil.core.can.frames import FrameBlock, empty_block
from hil.core.runtime.clock import Clock


class LogWire(ListeningWire):
    """A `Wire` whose next block is what was put into `shown`."""

    def __init__(self, name: str, clock: Clock) -> None:
        super().__init__(name, cast(can.BusABC, object()), clock)
        self.shown = empty_block()

    def drain(self) -> FrameBlock:
        """What was shown since the last call."""
        block, self.shown = self.shown, empty_block()
        return block
