"""Counts what is heard on a bus: frames by identifier, errors, and how busy it is on average and at worst."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

import numpy as np

from drivers import bits_on_the_wire, most_bits_on_the_wire
from hil.core.can.frames import ERROR_FRAME, EXTENDED, SENT_BY_HOST, FrameBlock
from hil.core.result import BusLoad
from hil.engine.bench.bench_tables import BenchFile


class Tally:
    """Counts what is heard on one bus."""

    def __init__(self) -> None:
        self._counts: dict[tuple[int, bool], int] = {}
        self._bits = 0
        self.errors = 0

    def take(self, block: FrameBlock) -> None:
        """Count the frames of one bus."""
        self._bits += int(bits_on_the_wire(block).sum())
        errors = block["flags"] & ERROR_FRAME != 0
        self.errors += int(np.count_nonzero(errors))
        others = block[~errors & (block["flags"] & SENT_BY_HOST == 0)]
        numbers, counts = np.unique(others["id"] << 1 | others["flags"] & EXTENDED, return_counts=True)
        for number, count in zip(numbers.tolist(), counts.tolist(), strict=True):
            key = (number >> 1, bool(number & 1))
            self._counts[key] = self._counts.get(key, 0) + count

    @property
    def frames(self) -> int:
        """Data frames of others so far."""
        return sum(self._counts.values())

    @property
    def standard_ids(self) -> set[int]:
        """Identifiers of 11 bits that others sent."""
        return {number for number, extended in self._counts if not extended}

    def load(self, bit_rate: int, duration_s: float) -> float:
        """Share of the time in which frames were on the wire."""
        return self._bits / bit_rate / duration_s

    def unknown(self, known: Collection[int], duration_s: float) -> dict[str, float]:
        """Frames a second of identifiers that are not known; an extended one never is."""
        return {
            f"0x{number:08X}" if extended else f"0x{number:03X}": round(count / duration_s, 1)
            for (number, extended), count in sorted(self._counts.items())
            if extended or number not in known
        }


def known_identifiers(file: BenchFile, bus: str) -> set[int]:
    """What the devices of a bench file send or hear on a bus."""
    tables = [table for table in file.device_tables.values() if getattr(table, "bus", None) == bus]
    return {number for table in tables for number in table.identifiers()}


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
