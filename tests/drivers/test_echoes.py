"""Own frames that come back are told from those of others, and nothing piles up."""

from __future__ import annotations

import time

import numpy as np

from drivers import CanSettings, Wire, open_can
from drivers.echoes import Echoes
from hil.core.can.frames import FRAME, SENT_BY_HOST
from hil.core.runtime.clock import WallClock
from sim_backend.serving import UdpHub
from tests.transports.far_ends import Served, looked_after


def test_a_frame_that_nobody_sent_here_is_none_of_ours() -> None:
    echoes = Echoes()
    echoes.expect(0x100, 7)
    assert not echoes.take(1.0, 0x100, 8)
    assert not echoes.take(1.0, 0x101, 7)
    assert echoes.take(1.0, 0x100, 7)
    assert not echoes.take(1.1, 0x100, 7)
    assert echoes.fetch() == [(1.0, 0x100, 7)]
    assert echoes.fetch() == []


def test_own_frames_leave_a_block() -> None:
    echoes = Echoes()
    echoes.expect(0x100, 0)
    block = np.zeros(3, FRAME)
    block["id"] = [0x110, 0x100, 0x111]
    block["flags"] = [0, SENT_BY_HOST, 0]
    assert echoes.others(block)["id"].tolist() == [0x110, 0x111]
    assert len(echoes.fetch()) == 1


def test_what_nobody_fetches_is_forgotten() -> None:
    echoes = Echoes()
    for number in range(20_000):
        echoes.expect(0x100, number)
        echoes.take(0.0, 0x100, number)
    assert len(echoes.fetch()) < 5000


def test_a_served_bus_shows_a_host_its_own_frames_if_it_asks() -> None:
    far = Served(UdpHub(0, 1_000_000, 1.0))
    settings = CanSettings("bus", "hil-udp", far.settings.channel, 1_000_000)
    assert settings.echoing
    clock = WallClock()
    offset_s = time.time() - clock.now_s()
    with looked_after(far):
        wire = Wire("bus", open_can(settings), clock, epoch_offset_s=offset_s, echoing=True)
        wire.send(0x100, b"\x07")
        seen = []
        for _ in range(2000):
            assert set(wire.drain()["flags"].tolist()) <= {SENT_BY_HOST}
            assert wire.echoes is not None
            seen += wire.echoes.fetch()
            if seen:
                break
            time.sleep(0.001)
    wire.close()
    far.leave()
    ((time_s, frame_id, payload),) = seen
    assert (frame_id, payload) == (0x100, 7)
    assert 0 <= time_s <= clock.now_s()
