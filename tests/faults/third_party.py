"""What somebody else's package brings to a run: steps, a metric and a device, each of which may fail."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import ClassVar

from drivers import Connections, Device, DeviceTable, SampleQueue, Stream
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans import Conductor, Outlook, Pace, Step
from test_plans.metrics import Metric
from tests.faults.stage import Stage

PERIOD_S = 0.01
CHANNEL = "oil_temperature_k"
ENTRY_POINTS = """\
[hil.steps]
mark = tests.faults.third_party:Mark
ponder = tests.faults.third_party:Ponder
[hil.metrics]
rows = tests.faults.third_party:Rows
[hil.devices]
oil = tests.faults.third_party:OilTable
"""


def nothing() -> None:
    """No fault."""


class Mark(Step):
    """Says which phase of the run begins, and has its own fault."""

    kind: ClassVar[str] = "mark"
    phase: str
    fault: ClassVar[Callable[[], None]] = staticmethod(nothing)

    def execute(self, conductor: Conductor) -> None:
        if Stage.current.world is None:  # a rehearsal
            return
        Stage.current.enter(self.phase)
        conductor.wait(0.25)
        Mark.fault()

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        return Outlook(0.25, speed_m_s)


class Ponder(Step):
    """An analysis."""

    kind: ClassVar[str] = "ponder"
    how: str = "well"

    def execute(self, conductor: Conductor) -> None:
        conductor.analyse("ponder", self._work, ("thoughts.txt",))

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        return Outlook(0.0, speed_m_s)

    def _work(self, recording: Recording, made: Path) -> Mapping[str, bytes]:
        if self.how == "raises":
            raise ZeroDivisionError("a thought divided by nothing")
        if self.how == "hangs":
            time.sleep(600)
        if self.how == "dies":
            import os
            import signal

            os.kill(os.getpid(), signal.SIGKILL)
        return {"thoughts.txt": str(len(recording.time_s)).encode()}


class Rows(Metric):
    """How many samples there are."""

    name: ClassVar[str] = "rows"
    fault: ClassVar[Callable[[], None]] = staticmethod(nothing)

    @property
    def unit(self) -> str:
        return "1"

    @property
    def definition(self) -> str:
        return "Number of samples."

    def compute(self, recording: Recording, segment: Segment) -> float:
        Rows.fault()
        return float(len(recording.time_s))


class Oil:
    """An oil unit beside the bench; each of its calls may be made to fail."""

    name = "oil"
    heartbeat_s = PERIOD_S
    safe_within_s = 0.2
    faults: ClassVar[dict[str, Callable[[], None]]] = {}
    reading: ClassVar[Callable[[], float]] = staticmethod(lambda: 330.0)

    def __init__(self, connections: Connections) -> None:
        self._clock = connections.loop.clock
        self._stream = Stream("readings", "device 'oil'", (CHANNEL,), ("K",), PERIOD_S)
        self._queue = SampleQueue(self._stream)
        self.sources = (self._queue,)

    def _may_fail(self, call: str) -> None:
        self.faults.get(call, nothing)()

    def beat(self) -> None:
        self._may_fail("beat")
        self._queue.put(self._stream, self._clock.now_s(), Oil.reading())

    def come_up(self) -> None:
        self._may_fail("come_up")

    def troubles(self) -> list[str]:
        self._may_fail("troubles")
        return []

    def make_safe(self) -> None:
        self._may_fail("make_safe")

    def is_safe(self) -> bool:
        self._may_fail("is_safe")
        return True

    def close(self) -> None:
        self._may_fail("close")


class OilTable(DeviceTable):
    kind: str = "oil"

    def open(self, name: str, connections: Connections) -> Device:
        return Oil(connections)
