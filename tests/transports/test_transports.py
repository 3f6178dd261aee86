"""The contract, transport by transport."""

from __future__ import annotations

import pytest

from drivers import Wire
from hil.core.errors import BenchError
from tests.transports.contract import TransportContract
from tests.transports.far_ends import FAR_ENDS


class TestVirtual(TransportContract):
    interface = "virtual"
    tells_that_the_other_end_left = False


class TestSimulated(TransportContract):
    interface = "hil-sim"
    tells_that_the_other_end_left = False
    far_end_sends_what_it_is_told = False

    def test_frames_of_its_devices_arrive(self, far, wire):
        far.world.sleep_until(0.25)
        received = self.received(wire, 1)
        assert {0x703, 0x704} <= set(received["id"].tolist())


class TestUdp(TransportContract):
    interface = "hil-udp"


class TestSlcan(TransportContract):
    interface = "slcan"
    keeps_stamps = False

    def test_what_the_adapter_says_of_the_bus_is_told(self, far, wire: Wire):
        far.server.say("sb000255")
        self.received(wire, 1)
        with pytest.raises(BenchError, match="bus-off"):
            wire.check()

    def test_at_another_bit_rate_nothing_passes(self, far, wire: Wire):
        far.server._set_rate = 500_000
        wire.send(0x100, b"")
        assert far.taken() == []


class TestSocketcand(TransportContract):
    interface = "socketcand"


def test_every_transport_has_its_contract():
    classes = TransportContract.__subclasses__()
    assert FAR_ENDS.keys() <= {contract.interface for contract in classes}
