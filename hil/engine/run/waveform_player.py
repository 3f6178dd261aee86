"""Plays a waveform of torque: one sample each tick."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from drivers import TakesBack
from hil.core.errors import BenchError
from hil.core.runtime.clock import without_collections
from hil.engine.bench.bench import Bench
from hil.engine.bench.request_timing import Periodic
from test_plans import Array, Quantity

#: An RMCU takes the first request at once; what it says of that is looked at every 10 ticks.
_FOLLOWS_WITHIN_TICKS = 100


class WaveformPlayer:
    """Sends requests; `passed` is how many ticks of the last ones have passed."""

    def __init__(self, bench: Bench, noted: Periodic | None) -> None:
        self._bench, self._noted = bench, noted
        self.passed = 0

    def send(self, quantity: Quantity, values_nm: Array, until: Callable[[], bool] = lambda: False) -> int:
        """Send one value each tick, before anything that could hold it up; says how many were sent.

        Fewer than there are if `until` held before the last of them.

        Raises:
            BenchError: the RMCU went to fault.
        """
        rmcu, loop, noted = self._bench.rmcu, self._bench.loop, self._noted
        payloads = rmcu.requests(quantity, values_nm)
        sent = 0

        def send(index: int) -> None:
            nonlocal sent
            meant_s = loop.tick_s if index else loop.clock.now_s()
            rmcu.send(int(payloads[index]))
            sent = index + 1
            if noted:
                noted.noted(meant_s)

        def ahead(index: int, times_s: Array) -> bool:
            nonlocal sent
            taken = rmcu.send_ahead(payloads[index : index + len(times_s)], times_s)
            sent = index + len(times_s) if taken else sent
            return taken

        self.passed = 0
        try:
            with (
                contextlib.nullcontext() if self._bench.simulated else without_collections(),
                contextlib.closing(loop.each_tick(len(payloads), send, ahead)) as ticks,
            ):
                for passed in ticks:
                    self._refuse_deafness(passed)
                    self.passed = passed
                    if until():
                        break
        finally:
            if noted:
                noted.rest()
            if sent < len(payloads) and isinstance(rmcu, TakesBack):
                rmcu.take_back(len(payloads) - sent)
        return sent

    def _refuse_deafness(self, passed: int) -> None:
        """Raises:
        BenchError: the RMCU went to fault, or does not do what is requested.
        """
        rmcu = self._bench.rmcu
        fix = "see the recording's events"
        if rmcu.state == "fault":
            raise BenchError(f"the RMCU went to fault: {rmcu.fault}", where="RMCU", fix=fix)
        if rmcu.state == "off" and passed > _FOLLOWS_WITHIN_TICKS:
            raise BenchError("the RMCU stays off, though torque is requested", where="RMCU", fix=fix)
