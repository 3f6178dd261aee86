"""How busy each bus of a run is, on average and in its busiest tenth of a second."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from drivers import most_bits_on_the_wire
from hil.core.can.frames import FrameBlock
from hil.core.result import BusLoad

_WINDOW_S = 0.1


class BusLoads:
    """Counts the bits of all frames, each with as many stuff bits as it may have."""

    def __init__(self, bit_rates: Mapping[str, int], now_s: Callable[[], float]) -> None:
        self._bit_rates, self._now_s = bit_rates, now_s
        self._begin_s = now_s()
        self._bits = {name: np.zeros(1, np.int64) for name in bit_rates}  # of each window

    def take_frames(self, bus: str, block: FrameBlock) -> None:
        """Count frames of one bus, sent and received, of which the last gives their time."""
        if not len(block):
            return
        passed_s = self._now_s() - self._begin_s
        since_s = float(block["time_s"][-1]) - self._begin_s
        if not 0.0 <= since_s <= passed_s:  # an adapter's stamp may be anything
            since_s = passed_s
        window, known = int(since_s / _WINDOW_S), self._bits[bus]
        if window >= len(known):  # twice as much room as is needed: seldom made larger
            self._bits[bus] = known = np.pad(known, (0, 2 * window + 1 - len(known)))
        known[window] += most_bits_on_the_wire(block)

    def results(self) -> tuple[BusLoad, ...]:
        """The load of each bus from the beginning until now."""
        passed_s = max(self._now_s() - self._begin_s, _WINDOW_S)
        return tuple(
            BusLoad(
                bus=name,
                bit_rate=rate,
                mean=round(float(self._bits[name].sum()) / rate / passed_s, 4),
                busiest=round(float(self._bits[name].max()) / rate / _WINDOW_S, 4),
            )
            for name, rate in self._bit_rates.items()
        )
