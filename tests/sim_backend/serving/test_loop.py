"""A bench in wall-clock time: by a clock that the test turns, stalls and all."""

from __future__ import annotations

import gc
import time

import numpy as np
import pytest

from drivers import read_rmcu
from hil.core.can.frames import crc8_many, empty_block, joined
from hil.core.model import load_model
from sim_backend.bench import SimulatedBench, SimulationSettings
from sim_backend.serving import BenchServer
from tests.benches_for_tests import SIM

STATUS = 0x110


class Turned:
    """A wall clock that passes only while somebody sleeps; now and then sleeping takes too long."""

    def __init__(self, stalls=()):
        self.now_s = 100.0
        self.stalls = dict(stalls)

    def __call__(self):
        return self.now_s

    def sleep(self, duration_s):
        self.now_s += max(duration_s, 1e-5)
        for at_s in [at_s for at_s in self.stalls if self.now_s >= at_s]:
            self.now_s += self.stalls.pop(at_s)


class Wire:
    lost = 0

    def __init__(self):
        self.table = {}
        self.waiting, self.blocks, self.closed = [], [], False

    def take(self):
        waiting, self.waiting = self.waiting, []
        return waiting

    def give(self, block):
        self.blocks.append(block)

    def close(self):
        self.closed = True

    @property
    def frames(self):
        return joined(self.blocks) if self.blocks else empty_block()

    @property
    def each_ms(self):
        """Stamps of a frame that comes every millisecond."""
        return self.frames["time_s"][self.frames["id"] == STATUS]


def served(for_s, scale=1.0, stalls=()):
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    clock, wires = Turned(stalls), {"rmcu": Wire(), "dyno": Wire()}
    server = BenchServer(world, wires, scale, clock=clock, sleep=clock.sleep)
    server.serve(lambda: False, for_s)
    return server, wires, clock


def test_bench_time_passes_as_the_wall_clock_does():
    server, wires, _ = served(1.0)
    assert server.pace.bench_time_s == pytest.approx(1.0, abs=0.002)
    assert (server.pace.stalls, server.pace.left_out_s) == (0, 0.0)
    stamps = wires["rmcu"].frames["time_s"]
    assert stamps[-1] - stamps[0] == pytest.approx(1.0, abs=0.003)
    assert len(stamps) == pytest.approx(3010, abs=10)
    assert server.frames["rmcu"] == [len(stamps), 0]


def test_slower_than_real_time_the_stamps_lie_further_apart():
    server, wires, _ = served(1.0, scale=0.2)
    assert server.pace.bench_time_s == pytest.approx(0.2, abs=0.002)
    np.testing.assert_allclose(np.diff(wires["rmcu"].each_ms), 0.005, atol=2e-6)


def test_a_stall_is_caught_up_with_and_told():
    server, wires, _ = served(1.0, stalls={100.5: 0.15}.items())
    assert (server.pace.stalls, server.pace.left_out_s) == (1, 0.0)
    assert server.pace.largest_stall_s == pytest.approx(0.15, abs=0.001)
    assert server.pace.bench_time_s == pytest.approx(1.0, abs=0.002)
    np.testing.assert_allclose(np.diff(wires["rmcu"].each_ms), 0.001, atol=2e-6)


def test_after_a_long_stall_the_bench_goes_on_where_it_stood_whole_milliseconds_later():
    server, wires, _ = served(1.8, stalls={100.5: 0.8}.items())
    assert server.pace.largest_stall_s == pytest.approx(0.8, abs=0.001)
    assert server.pace.left_out_s == pytest.approx(0.3, abs=0.002)
    assert server.pace.bench_time_s == pytest.approx(1.5, abs=0.004)
    gaps = np.diff(wires["rmcu"].each_ms)
    assert np.sum(gaps > 0.0011) == 1
    np.testing.assert_allclose(np.max(gaps), round(np.max(gaps), 3), atol=2e-6)


@pytest.mark.parametrize("stamped", [True, False])
def test_what_hosts_sent_during_a_stall_reaches_the_bench_when_it_was_sent(stamped, monkeypatch):
    """The RMCU must not think that its host was silent, nor that it spoke all at once."""
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    clock, wires = Turned({100.3: 0.15}), {"rmcu": Wire(), "dyno": Wire()}
    server = BenchServer(world, wires, clock=clock, sleep=clock.sleep)
    layout = read_rmcu(SIM.rmcu.dbc).layouts["RMCU_Request"]
    epoch_s, sent = 1.7e9, 0
    monkeypatch.setattr(time, "time", lambda: epoch_s + clock.now_s)

    def stop():
        nonlocal sent
        while 100.0 + 0.001 * sent < clock.now_s:  # a request each millisecond, whatever the bench does
            payload = layout.encode(Counter=np.array([sent % 16]), Mode=1, TorqueRequest=np.array([20.0]))
            payload |= layout.signals["Crc"].encode(crc8_many(layout.id, payload))
            stamp_s = epoch_s + 100.0 + 0.001 * sent if stamped else None
            data = int(payload[0]).to_bytes(8, "little")[: layout.length]
            wires["rmcu"].waiting.append((stamp_s, layout.id, data))
            sent += 1
        return False

    server.serve(stop, 0.6)
    assert server.pace.largest_stall_s == pytest.approx(0.15, abs=0.001)
    assert (world.rmcu.mode, world.rmcu.request) == (1, 20.0)


def test_frames_of_hosts_reach_the_bench_and_collections_pause():
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    clock, wires = Turned(), {"rmcu": Wire(), "dyno": Wire()}
    server = BenchServer(world, wires, clock=clock, sleep=clock.sleep)
    wires["dyno"].waiting = [(None, 0x000, bytes([1, 0]))]  # NMT: start all nodes
    collecting = []

    def stop():
        collecting.append(gc.isenabled())
        return False

    server.serve(stop, 0.01)
    assert world.dynos[0].operational
    assert server.frames["dyno"][1] == 1
    assert not any(collecting)
    assert gc.isenabled()
    server.close()
    assert wires["rmcu"].closed
    assert wires["dyno"].closed
