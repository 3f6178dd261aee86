"""The loop serves whatever gives bytes, and one that fails keeps no one else from being served."""

from __future__ import annotations

import os
import pty
import select
from collections.abc import Generator

import pytest

from drivers import BusLoop, SerialLine
from hil.core.errors import BenchError
from tests.clocks import SteppedClock


class Broken:
    def drain(self) -> bytes:
        raise BenchError("is unplugged")


class Given:
    def __init__(self, *pieces: bytes) -> None:
        self.pieces = list(pieces)

    def drain(self) -> bytes:
        return self.pieces.pop(0) if self.pieces else b""


def test_bytes_are_handed_out_with_their_time() -> None:
    loop, taken = BusLoop(SteppedClock(virtual=False), []), []
    loop.serve(Given(b"", b"one", b"two"), lambda data, time_s: taken.append((data, round(time_s, 6))))
    loop.run_for(0.05)
    assert taken == [(b"one", 0.02), (b"two", 0.03)]


def test_a_port_that_fails_is_told_after_the_others_were_served() -> None:
    loop, taken, drained = BusLoop(SteppedClock(virtual=False), []), [], []
    loop.serve(Broken(), lambda data, time_s: None)
    loop.serve(Given(b"one"), lambda data, time_s: taken.append(data))
    loop.on_drained(lambda: drained.append(True))
    with pytest.raises(BenchError, match="unplugged"):
        loop.drain()
    assert (taken, drained) == ([b"one"], [True])


def test_a_duty_that_fails_keeps_no_heartbeat_from_going() -> None:
    loop, beats = BusLoop(SteppedClock(virtual=False), []), []

    def fails() -> None:
        raise BenchError("bus off")

    loop.every(0.01, fails)
    loop.every(0.01, lambda: beats.append(True))
    with pytest.raises(BenchError, match="bus off"):
        loop.run_for(0.05)
    assert beats == [True]


def test_a_serial_line_sends_receives_and_says_when_it_is_gone() -> None:
    there, terminal = pty.openpty()
    line = SerialLine("panel", os.ttyname(terminal))
    assert line.drain() == b""
    os.write(there, b"\x00\xffhello\r\n\x11\x13")
    select.select([terminal], [], [], 1.0)
    assert line.drain() == b"\x00\xffhello\r\n\x11\x13"
    line.send(b"\x02OFF\r\x03")
    assert select.select([there], [], [], 1.0)[0]
    assert os.read(there, 100) == b"\x02OFF\r\x03"
    os.close(terminal)
    os.close(there)
    with pytest.raises(BenchError, match=r"device 'panel' \(/dev/.*\): sending failed"):
        line.send(b"x")
    with pytest.raises(BenchError, match=r"device 'panel' \(/dev/.*\): receiving failed"):
        line.drain()
    line.close()


def test_a_serial_line_that_takes_nothing_is_not_waited_for() -> None:
    there, terminal = pty.openpty()
    line = SerialLine("panel", os.ttyname(terminal))

    def flood() -> None:
        for _ in range(10_000):
            line.send(bytes(100))

    with pytest.raises(BenchError, match=r"device 'panel' \(/dev/.*\): sending failed"):
        flood()
    line.close()
    os.close(terminal)
    os.close(there)


def test_what_is_timed_comes_before_what_is_not_and_between_its_parts() -> None:
    clock = SteppedClock(virtual=False)
    loop = BusLoop(clock, [])
    late_s: list[float] = []

    def work() -> None:
        for _ in range(30):
            clock.time_s += 0.0005
            loop.keep_up()

    loop.every(0.02, work)
    loop.every(0.01, lambda: None, lambda meant_s: late_s.append(clock.time_s - meant_s))
    loop.run_for(0.2)
    assert len(late_s) == pytest.approx(clock.time_s / 0.01, abs=1)
    assert max(late_s) < 0.00051


class Busy:
    """A loop that sends, and work that takes 4.5 ms each time that wires were looked at."""

    def __init__(self, *, keeps_up: bool, part_s: float = 0.0005) -> None:
        self.clock = SteppedClock(virtual=False)
        self.loop = BusLoop(self.clock, [])
        self.sent: list[tuple[int, float, float]] = []
        self._keeps_up, self._part_s = keeps_up, part_s
        self.loop.on_drained(self._work)

    def _work(self) -> None:
        for _ in range(round(0.0045 / self._part_s)):
            self.clock.time_s += self._part_s
            if self._keeps_up:
                self.loop.keep_up()

    def each_tick(self, count: int) -> Generator[int, None, None]:
        return self.loop.each_tick(count, self._send, lambda index, times_s: False)

    def _send(self, number: int) -> None:
        self.sent.append((number, self.loop.tick_s, self.clock.time_s))


@pytest.mark.parametrize(("keeps_up", "latest_s"), [(True, 0.00051), (False, 0.0041)])
def test_long_work_holds_up_no_request_if_it_lets_the_loop_keep_up(keeps_up: bool, latest_s: float) -> None:
    busy = Busy(keeps_up=keeps_up)
    assert list(busy.each_tick(30))[-1] == 30
    assert [number for number, *_ in busy.sent] == list(range(30))
    meant = [meant_s for _, meant_s, _ in busy.sent]
    assert meant == pytest.approx([number * 1e-3 for number in range(30)])
    assert max(sent_s - meant_s for _, meant_s, sent_s in busy.sent) < latest_s


def test_work_in_small_parts_lets_a_tick_that_is_near_come_first() -> None:
    busy = Busy(keeps_up=True, part_s=0.00013)
    assert list(busy.each_tick(30))[-1] == 30
    assert [number for number, *_ in busy.sent] == list(range(30))
    assert max(sent_s - meant_s for _, meant_s, sent_s in busy.sent) < 1e-9


def test_what_is_left_early_is_sent_no_further() -> None:
    busy = Busy(keeps_up=True)
    ticks = busy.each_tick(100)
    next(ticks)
    ticks.close()
    busy.loop.run_for(0.05)
    assert [number for number, *_ in busy.sent] == [0, 1]


def test_a_fault_on_the_way_ends_the_sending() -> None:
    busy = Busy(keeps_up=True)

    def fail() -> None:
        raise BenchError("is unplugged")

    busy.loop.on_drained(fail)
    with pytest.raises(BenchError, match="unplugged"):
        list(busy.each_tick(100))
    count = len(busy.sent)
    busy.clock.time_s += 0.001
    busy.loop.keep_up()
    assert len(busy.sent) == count
