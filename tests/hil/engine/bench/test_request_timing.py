"""When requests were meant, sent and seen: what is summed up, what is recorded, and that nothing piles up."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest

from drivers.echoes import Echo
from hil.engine.bench.request_timing import Periodic, RequestTiming

PERIOD_S = 0.001


class AtHand:
    """A clock that is set by hand."""

    virtual = False

    def __init__(self) -> None:
        self.time_s = 0.0

    def now_s(self) -> float:
        return self.time_s

    def sleep_until(self, time_s: float) -> None:
        self.time_s = time_s


class Device:
    name = "RMCU"


class Line:
    """A wire that gives own frames back after `way_s`, but for those whose number is among the `lost`."""

    name = "rmcu"

    def __init__(self, clock: AtHand, way_s: float, lost: frozenset[int] = frozenset()) -> None:
        self._clock, self._way_s, self._lost = clock, way_s, lost
        self._number = 0
        self._back: list[Echo] = []
        self.last_sent: tuple[float, int, int] | None = None
        self.echoes = self

    def send(self) -> None:
        frame = (0x100, self._number % 16)
        self.last_sent = (self._clock.now_s(), *frame)
        if self._number not in self._lost:
            self._back.append(Echo(self._clock.now_s() + self._way_s, *frame))
        self._number += 1

    def fetch(self) -> list[Echo]:
        back, self._back = self._back, []
        return back


def sent(late_s: list[float], lost: frozenset[int] = frozenset()) -> tuple[RequestTiming, list[np.ndarray]]:
    """Requests, one each millisecond, each so much later than meant; 0.4 ms on their way."""
    clock, recorded = AtHand(), []
    line = Line(clock, 0.0004, lost)
    wires: list[Any] = [line]
    device: Any = Device()
    timing = RequestTiming(clock, wires, lambda name, now_s, times: recorded.append(times))
    noted = timing.of(device, "rmcu", "torque request", PERIOD_S)
    for number, late in enumerate(late_s):
        meant_s = 1.0 + number * PERIOD_S
        clock.time_s = meant_s + late
        line.send()
        noted.noted(meant_s)
        if number % 500 == 499:
            timing.collect()
    timing.collect(everything=True)
    return timing, recorded


def test_percentiles_and_the_latest_are_told_for_sending_and_for_the_bus() -> None:
    timing, recorded = sent([0.0001] * 980 + [0.0005] * 19 + [0.0009])
    (found,) = timing.results()
    assert (found.count, found.missed, found.unseen) == (1000, 0, 0)
    assert (found.sent.p50_ms, found.sent.p99_ms, found.sent.max_ms) == pytest.approx(
        (0.1, 0.5, 0.9), abs=2e-3
    )
    assert found.seen is not None
    assert (found.seen.p50_ms, found.seen.max_ms) == pytest.approx((0.5, 1.3), abs=2e-3)
    times = np.hstack(recorded)
    assert times.shape == (3, 1000)
    np.testing.assert_allclose(times[2] - times[1], 0.0004)


def test_a_request_that_was_later_than_the_histogram_reaches_is_told_by_the_latest() -> None:
    timing, _ = sent([0.0] * 10 + [0.25])
    (found,) = timing.results()
    assert (found.sent.p50_ms, found.sent.max_ms) == pytest.approx((0.0, 250.0), abs=2e-3)
    assert found.sent.p99_ms == 250.0


def test_cycles_that_were_late_by_a_cycle_or_more_are_missed() -> None:
    timing, _ = sent([0.0] * 10 + [0.0030, 0.0021, 0.0012, 0.0003] + [0.0] * 10)
    (found,) = timing.results()
    assert (found.count, found.missed) == (24, 3)


def test_cycles_that_were_left_out_are_missed_but_not_those_after_a_rest() -> None:
    clock = AtHand()
    noted = Periodic(clock, None, "torque request", "RMCU", PERIOD_S)
    for meant_s in (1.0, 1.001, 1.005, None, 7.0, 7.001):
        if meant_s is None:
            noted.rest()
            continue
        clock.time_s = meant_s
        noted.noted(meant_s)
    noted.settled([], np.inf)
    found = noted.result()
    assert (found.count, found.missed, found.seen) == (5, 3, None)


def test_an_echo_that_was_lost_moves_no_other() -> None:
    timing, recorded = sent([0.0] * 100, lost=frozenset({3, 50, 51}))
    (found,) = timing.results()
    assert found.unseen == 3
    assert found.seen is not None
    assert found.seen.max_ms == pytest.approx(0.4, abs=2e-3)
    assert np.flatnonzero(np.isnan(np.hstack(recorded)[2])).tolist() == [3, 50, 51]


def test_an_echo_that_is_still_on_its_way_is_waited_for() -> None:
    clock, recorded = AtHand(), []
    line = Line(clock, 0.0004)
    timing = RequestTiming(clock, [line], lambda name, now_s, times: recorded.append(times))  # type: ignore[list-item]
    noted = timing.of(Device(), "rmcu", "torque request", PERIOD_S)  # type: ignore[arg-type]
    clock.time_s = 1.0
    line.send()
    noted.noted(1.0)
    on_its_way, line._back = line._back, []
    clock.time_s = 1.2
    timing.collect()
    assert recorded == []
    line._back = on_its_way
    timing.collect()
    (times,) = recorded
    np.testing.assert_allclose(times.ravel(), (1.0, 1.0, 1.0004))
    line.send()
    noted.noted(1.2)
    line._back = []
    clock.time_s = 1.46  # a quarter of a second later it does not come any more
    timing.collect()
    assert np.isnan(recorded[1][2]).all()


def test_an_hour_needs_no_more_memory_than_a_second() -> None:
    clock = AtHand()
    noted = Periodic(clock, None, "torque request", "RMCU", PERIOD_S)

    def size() -> int:
        return sum(sys.getsizeof(part) for part in vars(noted).values())

    sizes = []
    for part in range(20):
        for number in range(500):
            noted.noted(part * 0.5 + number * PERIOD_S)
        noted.settled([], np.inf)
        sizes.append(size())
    assert sizes[1] == sizes[-1]
    assert noted.count == 10_000
