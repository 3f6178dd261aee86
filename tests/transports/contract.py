"""What every transport owes to the drivers: one class of tests, subclassed for each."""

from __future__ import annotations

import contextlib
import time

import numpy as np
import pytest

from drivers import BusHealth, Wire, open_can
from hil.core.can.frames import EXTENDED, SENT_BY_HOST, empty_block, joined
from hil.core.errors import BenchError
from hil.core.runtime.clock import WallClock
from tests.transports.far_ends import FAR_ENDS, block_of, looked_after

_LOOKS = 2000
_BURST = 400  # what two busy buses bring while a host looks elsewhere for 100 ms


class TransportContract:
    """Tests of one transport; `interface` names it."""

    interface: str
    keeps_stamps = True  # those of the sending side
    tells_that_the_other_end_left = True
    far_end_sends_what_it_is_told = True

    @pytest.fixture
    def far(self):
        far = FAR_ENDS[self.interface]()
        self._left = False
        yield far
        if not self._left:
            far.leave()

    @pytest.fixture
    def wire(self, far):
        clock = WallClock()
        self.offset_s = time.time() - clock.now_s()
        with looked_after(far) if hasattr(far, "server") else contextlib.nullcontext():
            bus = open_can(far.settings)
        health = BusHealth("bus", far.settings.interface, bus)
        wire = Wire("bus", bus, clock, epoch_offset_s=self.offset_s, health=health)
        yield wire
        wire.close()

    def received(self, wire, count):
        """Frames of the other end, at least `count`: looked for again and again, as a loop does."""
        blocks = []
        for _ in range(_LOOKS):
            block = wire.drain()
            blocks.append(block[block["flags"] & SENT_BY_HOST == 0])
            if sum(map(len, blocks)) >= count:
                break
            time.sleep(0.001)
        return joined(blocks) if blocks else empty_block()

    def needs_telling(self):
        if not self.far_end_sends_what_it_is_told:
            pytest.skip("its other end sends what its devices send")

    def test_frames_of_every_length_reach_the_other_end_in_order(self, far, wire):
        sent = [(0x100 + length, bytes(range(length))) for length in range(9)] + [
            (0, b"\x01\x03"),
            (0x7FF, b""),
        ]
        for frame_id, data in sent:
            wire.send(frame_id, data)
        arrived = []
        for _ in range(_LOOKS):
            arrived += far.taken()
            if len(arrived) >= len(sent):
                break
            time.sleep(0.001)
        assert arrived == sent

    def test_what_was_sent_stands_in_the_record(self, wire):
        wire.send(0x123, b"\x01\x02")
        block = wire.drain()
        own = block[block["flags"] == SENT_BY_HOST]
        assert [(int(f["id"]), int(f["length"]), int(f["data"])) for f in own] == [(0x123, 2, 0x0201)]
        assert not np.any(wire.drain()["flags"] & SENT_BY_HOST)

    def test_nothing_is_waited_for(self, far, wire):
        self.needs_telling()
        assert len(wire.drain()) == 0

    def test_frames_arrive_as_they_were_sent(self, far, wire):
        self.needs_telling()
        block = block_of(range(0x100, 0x100 + 30), stamp_s=self.offset_s + 0.5)
        far.put(block)
        received = self.received(wire, len(block))
        for column in ("id", "length", "data", "flags"):
            np.testing.assert_array_equal(received[column], block[column])
        assert np.all(np.diff(received["time_s"]) >= 0)
        if self.keeps_stamps:
            np.testing.assert_allclose(received["time_s"], 0.5 + 0.0001 * np.arange(30), atol=2e-6)

    def test_extended_identifiers_are_told_from_standard_ones(self, far, wire):
        self.needs_telling()
        far.put(block_of([0x1ABCDEF0, 0x123], stamp_s=time.time(), flags=EXTENDED))
        received = self.received(wire, 2)
        assert received["id"].tolist() == [0x1ABCDEF0, 0x123]
        assert received["flags"].tolist() == [EXTENDED, EXTENDED]

    def test_a_burst_is_not_lost(self, far, wire):
        self.needs_telling()
        for first in range(0, _BURST, 40):
            far.put(block_of(np.arange(first, first + 40) % 0x800, stamp_s=time.time()))
        received = self.received(wire, _BURST)
        assert received["id"].tolist() == [i % 0x800 for i in range(_BURST)]
        assert wire.remarks == []
        wire.check()

    def test_the_other_end_that_leaves_is_told(self, far, wire):
        if not self.tells_that_the_other_end_left:
            pytest.skip("it has no other end that could leave")
        self._left = True
        far.leave()

        def go_on():
            for _ in range(_LOOKS):
                wire.drain()
                wire.send(0x100, b"")
                time.sleep(0.001)

        with pytest.raises(BenchError, match=r"bus 'bus'.*failed") as caught:
            go_on()
        assert caught.value.exit_code == 3

    def test_it_can_be_closed_again(self, wire):
        wire.close()

    def test_where_nobody_is_nothing_is_opened(self):
        if self.interface == "virtual":
            pytest.skip("it makes its other end itself")
        far = FAR_ENDS[self.interface]()
        far.leave()
        with pytest.raises(BenchError, match="cannot be opened") as caught:
            open_can(far.settings)
        assert caught.value.where.startswith(f"bus 'bus' ({self.interface} ")
