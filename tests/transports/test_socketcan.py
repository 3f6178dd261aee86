"""SocketCAN, where there is any: HIL_SOCKETCAN=can0:can1, two on one bus that this test may take down.

Without hardware in an emulated machine; docs/reference/transports.md says how. Never on a bench.
"""

from __future__ import annotations

import logging
import os
import time

import can
import pytest

from drivers import BusHealth, BusLoop, CanSettings, Wire, open_can
from hil.core.can.frames import EXTENDED, FrameBlock
from hil.core.errors import BenchError
from hil.core.runtime.clock import WallClock
from tests.can_vm.interfaces import ip, plugged_in, unplugged, up
from tests.transports import contract, far_ends

NEAR, _, FAR = os.environ.get("HIL_SOCKETCAN", "").partition(":")
BIT_RATE = 500_000

pytestmark = [
    pytest.mark.skipif(not FAR, reason="no SocketCAN interfaces are named in HIL_SOCKETCAN"),
    # python-can leaves the socket of an interface that cannot be opened to the garbage collection
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


class SocketCan:
    """The other end is another interface on the same bus."""

    def __init__(self) -> None:
        self.settings = CanSettings("bus", "socketcan", NEAR, BIT_RATE)
        self._bus = can.Bus(interface="socketcan", channel=FAR)

    def put(self, block: FrameBlock) -> None:
        for frame in block:
            data = int(frame["data"]).to_bytes(8, "little")[: int(frame["length"])]
            extended = bool(frame["flags"] & EXTENDED)
            self._bus.send(can.Message(0.0, int(frame["id"]), extended, data=data), timeout=1.0)

    def taken(self) -> list[tuple[int, bytes]]:
        found = []
        while (message := self._bus.recv(0)) is not None:
            found.append((message.arbitration_id, bytes(message.data)))
        return found

    def leave(self) -> None:
        self._bus.shutdown()


@pytest.fixture(autouse=True)
def _known(monkeypatch):
    monkeypatch.setitem(far_ends.FAR_ENDS, "socketcan", SocketCan)


class TestSocketcan(contract.TransportContract):
    interface = "socketcan"
    keeps_stamps = False  # the kernel stamps what arrives
    tells_that_the_other_end_left = False  # that no one acknowledges frames is told by error frames

    def test_where_nobody_is_nothing_is_opened(self):
        with pytest.raises(BenchError, match="cannot be opened: .*No such device"):
            open_can(CanSettings("bus", "socketcan", "none7", BIT_RATE))


@pytest.fixture
def loop():
    bus = open_can(CanSettings("rmcu", "socketcan", NEAR, BIT_RATE))
    clock = WallClock()
    offset_s = time.time() - clock.now_s()
    wire = Wire("rmcu", bus, clock, epoch_offset_s=offset_s, health=BusHealth("rmcu", "socketcan", bus))
    loop = BusLoop(clock, [wire])
    loop.on_drained(wire.check)
    yield loop
    wire.close()


def failure(loop: BusLoop) -> str:
    with pytest.raises(BenchError) as caught:
        loop.run_for(1.0)
    return str(caught.value)


def test_the_receive_buffer_is_raised_and_what_was_granted_is_told(caplog):
    caplog.set_level(logging.INFO)
    open_can(CanSettings("rmcu", "socketcan", NEAR, BIT_RATE)).shutdown()
    (told,) = [text for text in caplog.messages if "granted" in text]
    assert int(told.split("buffer of ")[1].split()[0]) >= 8 << 20  # root may go beyond the system's bound


def test_of_a_flood_while_nobody_looks_nothing_is_lost_unsaid(loop):
    (wire,) = loop.wires
    with can.Bus(interface="socketcan", channel=FAR) as far:
        for number in range(5000):
            far.send(
                can.Message(arbitration_id=number % 0x800, is_extended_id=False, data=bytes(8)), timeout=1
            )
        time.sleep(0.5)
    arrived = len(wire.drain())
    assert arrived == 5000 or "the adapter lost frames: its receive buffer was full" in wire.remarks


def test_a_network_that_is_down_is_told(loop):
    ip(NEAR, "down")
    try:
        assert "the network interface is down" in failure(loop)
        with pytest.raises(BenchError, match="the network interface is down"):
            loop.wires[0].send(0x100, b"")
    finally:
        up(NEAR, BIT_RATE)


@pytest.mark.skipif(NEAR.startswith("vcan"), reason="no bus of its own")
def test_a_bus_on_which_nobody_acknowledges_is_told(loop):
    """Only with real controllers: emulated ones acknowledge themselves; then nothing is reported."""
    ip(FAR, "down")
    try:
        for _ in range(50):
            loop.wires[0].send(0x100, bytes(8))
            loop.step()
    except BenchError as error:
        assert "error-passive" in str(error) or "bus-off" in str(error)
    finally:
        up(FAR, BIT_RATE)


@pytest.mark.skipif(not os.access("/sys/bus/pci/rescan", os.W_OK), reason="no PCI")
@pytest.mark.skipif(NEAR.startswith("vcan"), reason="no adapter")
def test_an_adapter_that_is_unplugged_is_told(loop):
    unplugged(NEAR)
    try:
        told = failure(loop)
        assert "the network interface is down" in told or "the adapter is gone" in told
        with pytest.raises(BenchError, match="the adapter is gone"):
            loop.wires[0].send(0x100, b"")
    finally:
        plugged_in(NEAR, BIT_RATE)
