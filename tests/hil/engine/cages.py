"""A device beside the simulated bench that reads what a test wants: a cage that is shut (1) or open (0)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drivers import Connections, Device, DeviceTable, SampleQueue, Stream
from hil.engine.bench.ranges import Interlock

CHANNEL = "cage_shut"
PERIOD_S = 0.01


class Cage:
    """Says every 10 ms of bench time what `reading` gives for it."""

    name = "cage"
    heartbeat_s = PERIOD_S
    safe_within_s = 0.1

    def __init__(self, connections: Connections, reading: Callable[[float], float]) -> None:
        self._clock, self._reading = connections.loop.clock, reading
        self._stream = Stream("readings", "device 'cage'", (CHANNEL,), ("1",), PERIOD_S)
        self._queue = SampleQueue(self._stream)
        self.sources = (self._queue,)
        self.emergency = ""

    def beat(self) -> None:
        now_s = self._clock.now_s()
        value = self._reading(now_s)
        self.emergency = "the button was pressed" if value < 0 else ""
        self._queue.put(self._stream, now_s, value)

    def come_up(self) -> None: ...
    def make_safe(self) -> None: ...
    def close(self) -> None: ...

    def troubles(self) -> list[str]:
        return []

    def is_safe(self) -> bool:
        return True


class CageTable(DeviceTable):
    kind: str = "cage"
    reading: Any

    def open(self, name: str, connections: Connections) -> Device:
        return Cage(connections, self.reading)


def cage(reading: Callable[[float], float]) -> dict[str, DeviceTable]:
    """What stands under [devices]."""
    return {"cage": CageTable(reading=reading)}


def shut(**changes: Any) -> dict[str, Interlock]:
    """What stands under [interlocks]: the cage must be shut."""
    keys = {
        "channel": CHANNEL,
        "unit": "1",
        "below": 0.5,
        "message": "shut the cage",
        "persistence_samples": 2,
    }
    return {"cage": Interlock(**{**keys, **changes})}
