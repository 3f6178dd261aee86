"""Adapters that speak slcan: what they say of the bus ends a run in plain words, whatever is sent to them."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

import can
import pytest

from drivers import BusHealth, BusLoop, Wire, open_can
from drivers.bus_health import remark
from drivers.slcan import _message
from hil.core.can.frames import ERROR_FRAME
from hil.core.errors import BenchError
from tests.clocks import SteppedClock
from tests.drivers.pseudo_adapter import PseudoAdapter, plugged_in, warnings_in


@contextlib.contextmanager
def wired() -> Iterator[tuple[PseudoAdapter, BusLoop, Wire]]:
    with plugged_in() as adapter:
        clock, bus = SteppedClock(virtual=False), open_can(adapter.settings())
        wire = Wire("rmcu", bus, clock, health=BusHealth("rmcu", "slcan", bus))
        loop = BusLoop(clock, [wire])
        loop.on_drained(wire.check)
        try:
            yield adapter, loop, wire
        finally:
            wire.close()


def test_it_is_opened_with_the_bit_rate_of_the_bench_file():
    with wired() as (adapter, _, _):
        assert adapter.heard()[-4:] == ["S6", "", "O", "O"]


def test_it_is_opened_on_a_bus_that_is_never_quiet():
    with plugged_in() as adapter, _talking(adapter) as talks:
        bus = open_can(adapter.settings())
        assert talks()
        heard = [bus.recv(1.0) for _ in range(100)]
        assert talks()
        bus.shutdown()
    assert all(m and not m.is_error_frame and (m.arbitration_id, len(m.data)) == (0x1E0, 8) for m in heard)


@contextlib.contextmanager
def _talking(adapter: PseudoAdapter) -> Iterator[Callable[[], bool]]:
    """Others send a frame each millisecond, for three seconds at most; whether they still do."""
    over = threading.Event()

    def talk() -> None:
        for _ in range(3000):
            if over.wait(0.001):
                return
            with contextlib.suppress(BlockingIOError):
                adapter.mutter("t1e08e1a1b255e1a1e1a1")

    thread = threading.Thread(target=talk)
    thread.start()
    try:
        yield thread.is_alive
    finally:
        over.set()
        thread.join()


def test_frames_pass_both_ways():
    with wired() as (adapter, loop, wire):
        adapter.heard()
        wire.send(0x100, b"\x01\xab")
        assert adapter.heard() == ["t100201AB"]
        blocks = []
        loop.on_block(lambda bus, block: blocks.append(block))
        adapter.say("t1108DEADBEEF01020304", "z", "T1ABCDEF02FFFF", "t7FF0", "t1104AB", "tzzz", "r1105")
        loop.run_for(0.02)
        received = [frame for block in blocks for frame in block if frame["flags"] != 2]
        assert [int(frame["id"]) for frame in received] == [0x110, 0x1ABCDEF0, 0x7FF]
        assert int(received[0]["data"]).to_bytes(8, "little").hex().upper() == "DEADBEEF01020304"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("sp000130", "error-passive: .*transmit 130, receive 0"),
        ("sb000255", "bus-off: .*transmit 255"),
        ("e1O", "the transmit queue is full"),
        ("\a", "the transmit queue is full"),
    ],
)
def test_what_ends_a_run_is_told_once_within_100_ms_of_the_clock(line, said):
    with wired() as (adapter, loop, _):
        loop.run_for(0.05)
        adapter.say(line, line)
        with pytest.raises(BenchError, match=said) as caught:
            loop.run_for(0.1)
        assert caught.value.where == "bus 'rmcu'"
        adapter.say(line)
        loop.run_for(0.1)


def test_frames_that_came_with_the_news_are_handed_out_all_the_same():
    with wired() as (adapter, loop, _):
        blocks = []
        loop.on_block(lambda bus, block: blocks.append(block))
        adapter.say("t1100", "sb000255", "t1110")
        with pytest.raises(BenchError, match="bus-off"):
            loop.run_for(0.1)
        (block,) = blocks
        assert block["id"].tolist() == [0x110, 0x40, 0x111]
        assert block["flags"].tolist() == [0, ERROR_FRAME | 1, 0]


def test_a_warning_and_single_errors_end_nothing(caplog):
    with wired() as (adapter, loop, _):
        adapter.say("sw100100", "e2ab", "sa000000", "e", "s", "e9", "sq000000")
        loop.run_for(0.1)
    assert warnings_in(caplog) == ["bus 'rmcu': error warning: 96 errors or more were counted"]
    warning = _message(b"sw100101", 0.0)
    assert warning is not None
    assert remark(warning).startswith("error warning")
    assert (warning.data[7], warning.data[6]) == (100, 101)


def test_a_line_that_takes_nothing_is_a_full_queue_and_not_waited_for():
    with wired() as (adapter, _, wire):

        def flood():
            for _ in range(100_000):
                wire.send(0x100, bytes(8))

        with pytest.raises(BenchError, match="the transmit queue is full"):
            flood()
        told = adapter.heard()
        wire.send(0x101, b"\x07")
        assert adapter.heard()[-1] == "t101107"  # not the end of a line that was cut off
        assert len(told) > 10


def test_an_adapter_that_is_unplugged_is_told():
    with wired() as (adapter, loop, wire):
        adapter.unplug()
        with pytest.raises(BenchError, match="receiving failed: the adapter is gone"):
            loop.run_for(0.1)
        with pytest.raises(BenchError, match="sending failed: the adapter is gone"):
            wire.send(0x100, b"")


@pytest.mark.parametrize("length", [12, 64])
def test_long_frames_of_can_fd_are_left_out_and_told(length, caplog):
    dlc = can.util.len2dlc(length)
    message = _message(f"d110{dlc:X}{'00' * length}".encode(), 0.0)
    assert (message.is_fd, message.bitrate_switch, len(message.data)) == (True, False, length)
    with wired() as (adapter, loop, _):
        blocks = []
        loop.on_block(lambda bus, block: blocks.append(block))
        adapter.say(f"b110{dlc:X}{'00' * length}", "t1110")
        loop.run_for(0.02)
        assert [block["id"].tolist() for block in blocks] == [[0x111]]
    assert warnings_in(caplog) == ["bus 'rmcu': CAN FD frames of more than 8 bytes are left out"]
