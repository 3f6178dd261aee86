"""The bus in another process, here in another socket: what python-can sees of it."""

from __future__ import annotations

import contextlib
import socket
import time

import can
import numpy as np
import pytest

from drivers import Wire
from hil.core.can.frames import FRAME
from hil.core.errors import BenchError
from sim_backend.serving import UdpHub
from sim_backend.udp_interface import LoopbackBus
from tests.clocks import SteppedClock


class Hub(UdpHub):
    """A hub that answers by itself while a host connects."""

    def __init__(self, time_scale=1.0):
        super().__init__(0, 500_000, time_scale)
        self.heard = []
        self.channel = self.table["channel"]

    def connect(self, **kwargs):
        import threading

        done = threading.Event()

        def answer():
            while not done.wait(0.001):
                self.heard += self.take()

        thread = threading.Thread(target=answer)
        thread.start()
        try:
            return can.Bus(interface="hil-udp", channel=self.channel, **kwargs)
        finally:
            done.set()
            thread.join()


@contextlib.contextmanager
def hub(**kwargs):
    opened = Hub(**kwargs)
    try:
        yield opened
    finally:
        opened.close()


def block_of(*ids, stamp=1.7e9):
    block = np.zeros(len(ids), FRAME)
    block["time_s"], block["id"], block["length"], block["data"] = stamp, ids, 2, 0xAB01
    return block


def test_frames_pass_both_ways_with_the_stamps_of_their_sender():
    with hub() as served, served.connect(bitrate=500_000) as bus:
        assert isinstance(bus, LoopbackBus)
        assert bus.time_scale == 1.0
        bus.send(can.Message(arbitration_id=0x123, data=b"\x01\x02\x03", is_extended_id=False))
        ((sent_s, *frame),) = served.take()
        assert frame == [0x123, b"\x01\x02\x03"]
        assert sent_s == pytest.approx(time.time(), abs=60)
        served.give(block_of(0x10, 0x11))
        first = bus.recv(1.0)
        assert (first.arbitration_id, first.data, first.timestamp) == (0x10, b"\x01\xab", 1.7e9)
        assert bus.recv(1.0).arbitration_id == 0x11
        assert bus.recv(0) is None


def test_it_is_a_bus_hosts_hear_each_other():
    with hub() as served, served.connect() as one, served.connect() as other:
        one.send(can.Message(arbitration_id=5, is_extended_id=True))
        assert served.take() == []  # the bench's own frames are standard ones
        message = other.recv(1.0)
        assert (message.arbitration_id, message.is_extended_id) == (5, True)
        assert one.recv(0) is None


def test_lost_frames_are_counted_and_told_on_both_sides(caplog):
    with hub() as served, served.connect() as bus:
        host = next(iter(served._hosts.values()))
        served.give(block_of(1))
        host.outgoing.packed(block_of(2, 3))  # made, and never sent
        served.give(block_of(4))
        wire = Wire("rmcu", bus, SteppedClock(virtual=False), epoch_offset_s=1.7e9)
        assert wire.drain()["id"].tolist() == [1, 4]
        assert wire.remarks == ["2 frames were lost on the way"]
        assert "2 frames lost on the way so far" in caplog.text
        bus.send_frame(1, b"")
        bus._outgoing.packed(block_of(2, 3, 4))
        bus.send_frame(5, b"")
        assert [frame_id for _, frame_id, _ in served.take()] == [1, 5]
        assert served.lost == 3
        bus.shutdown()
        served.take()
        assert served.lost == 3


def test_a_host_that_was_busy_for_long_takes_part_again_and_knows_what_it_missed():
    with hub() as served, served.connect() as bus:
        served.give(block_of(1))
        assert bus.recv(1.0).arbitration_id == 1
        host = next(iter(served._hosts.values()))
        host.heard_s -= 60.0
        served.give(block_of(2, 3))
        bus._hello_s -= 60.0
        assert bus.recv(0) is None
        served.take()
        served.give(block_of(4))
        assert bus.recv(1.0).arbitration_id == 4
        assert bus.lost == 2


def test_a_bench_that_ends_is_told():
    with hub() as served:
        bus = served.connect()
        wire = Wire("rmcu", bus, SteppedClock(virtual=False))
        served.close()
        with pytest.raises(BenchError, match="receiving failed: the bench at .* has ended"):
            wire.drain()
        wire.close()


def test_a_bench_that_is_killed_is_told():
    served = Hub()
    bus = served.connect()
    wire = Wire("rmcu", bus, SteppedClock(virtual=False))
    served._socket.close()  # without a word
    wire.send(1, b"")
    with pytest.raises(BenchError, match="failed: the other end is no longer connected"):
        wire.send(1, b"")
    wire.close()


def test_what_does_not_fit_is_refused_with_words():
    with hub() as served:
        with pytest.raises(can.CanInitializationError, match="runs at 500000 bit/s, not at 1000000"):
            served.connect(bitrate=1_000_000)
        with served.connect() as bus, pytest.raises(can.CanOperationError, match="at most 8 bytes"):
            bus.send(can.Message(arbitration_id=1, data=bytes(12), is_fd=True))
    with pytest.raises(can.CanInitializationError, match="is not an address on this machine"):
        can.Bus(interface="hil-udp", channel="10.0.0.1:5000")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        with pytest.raises(OSError, match="in use"):
            UdpHub(port, 500_000, 1.0)
    with pytest.raises(can.CanInitializationError, match="no simulated bench at .*'hil bench sim'"):
        can.Bus(interface="hil-udp", channel=f"127.0.0.1:{port}")


def test_strangers_are_not_listened_to():
    with hub() as served, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        host, _, port = served.channel.rpartition(":")
        from sim_backend.datagrams import Outgoing

        for datagram in (b"", b"x" * 100, *Outgoing().packed(block_of(1))):
            stranger.sendto(datagram, (host, int(port)))
        assert served.take() == []
