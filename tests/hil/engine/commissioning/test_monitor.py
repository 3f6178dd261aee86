"""A bench is listened to, and nothing is sent."""

import contextlib
import math
import threading
import time

import numpy as np
import pytest

from drivers import BusLoop
from hil.core.can.frames import ERROR_FRAME, frames
from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.engine import StopRequest
from hil.engine.bench.bench import bench_clock, open_wire
from hil.engine.bench.bus_tally import Tally
from hil.engine.commissioning.monitor import MonitorRequest, View, _Stretch, monitor
from sim_backend.bench import SimulatedBench, SimulationSettings
from sim_backend.serving import BenchServer, UdpHub
from tests.benches_for_tests import SIM, sim_bench
from tests.clocks import SteppedClock
from tests.drivers.pseudo_adapter import plugged_in


@contextlib.contextmanager
def served():
    """A simulated bench in a thread: the bench file that connects to it, and what came from hosts."""
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    hubs = {name: UdpHub(0, 1_000_000, 1.0) for name in SIM.buses}
    server = BenchServer(world, hubs)
    ended = threading.Event()
    thread = threading.Thread(target=server.serve, args=(ended.is_set,))
    thread.start()
    try:
        buses = {
            name: SIM.buses[name].model_copy(update={"interface": "hil-udp", "channel": hub.table["channel"]})
            for name, hub in hubs.items()
        }
        yield sim_bench("served", buses=buses, simulation=None), server
    finally:
        ended.set()
        thread.join()
        server.close()


def test_channels_and_load_without_a_single_frame_of_ours():
    views: list[View] = []
    notes: list[str] = []
    with served() as (bench, server):
        monitor(MonitorRequest(bench, 0.1, 0.1))  # what is compiled the first time is compiled
        request = MonitorRequest(bench, 0.2, 0.6, begin=notes.extend, show=views.append)
        whole = monitor(request)
        time.sleep(0.02)
        assert [received for _, received in server.frames.values()] == [0, 0]
    assert notes == ["bus 'rmcu': nothing is sent", "bus 'dyno': nothing is sent"]
    assert views
    speed = whole.channels["motor_speed_rad_s"]
    assert speed.unit == "rad/s"
    assert abs(speed.value) < 0.2
    assert speed.lowest <= speed.value <= speed.highest
    assert speed.lowest < speed.highest
    assert speed.samples_s > 500
    assert math.isnan(whole.channels["wheel_speed_left_rad_s"].value)  # the dynos have not been started
    assert 0.1 < whole.buses["rmcu"].load < 0.6
    assert whole.devices["rmcu"] == "off"


def test_rates_are_of_the_stretch_alone():
    clock = SteppedClock()
    clock.time_s = 5.0
    stretch = _Stretch(SIM, BusLoop(clock, []), {})
    tally = stretch.tallies["rmcu"] = Tally()
    tally.take(frames(0x110, np.zeros(100, np.uint64), 8, 5.0))
    tally.take(frames(0x7, np.zeros(10, np.uint64), 0, 5.0, flags=ERROR_FRAME))
    clock.time_s = 7.0
    view = stretch.view(4.0)
    assert (view.time_s, view.duration_s) == (3.0, 2.0)
    bus = view.buses["rmcu"]
    assert (bus.frames_s, bus.errors_s, bus.unknown) == (50.0, 5.0, {})
    assert bus.load == tally.load(1_000_000, 2.0)


def test_an_adapter_that_can_is_told_to_listen_only():
    with plugged_in() as rmcu, plugged_in() as dyno:
        buses = {
            name: SIM.buses[name].model_copy(
                update={"interface": "slcan", "channel": end.path, "options": {"sleep_after_open": 0}}
            )
            for name, end in {"rmcu": rmcu, "dyno": dyno}.items()
        }
        notes: list[str] = []
        monitor(MonitorRequest(sim_bench("s", buses=buses, simulation=None), 0.1, 0.1, begin=notes.extend))
        said = rmcu.heard()
    assert "L" in said
    assert "O" not in said
    assert not any(line[:1] in tuple("tTrR") for line in said), said
    assert notes[0] == "bus 'rmcu': the adapter listens only"


def test_a_wire_that_is_listened_to_refuses_to_send():
    bench = sim_bench("listened")
    with contextlib.ExitStack() as opened:
        clock, offset_s = bench_clock(bench, load_model(SIM.simulation.model), opened)
        wire = open_wire(bench, "rmcu", clock, offset_s, opened, listen_only=True)
        with pytest.raises(BenchError, match="0x100 was to be sent on a bus that is only listened to"):
            wire.send(0x100, bytes(8))


def test_asking_to_stop_ends_it():
    stop = StopRequest()
    with served() as (bench, _):
        whole = monitor(MonitorRequest(bench, 0.1, show=lambda view: stop.ask(), stop=stop))
    assert whole.time_s < 10


def test_a_simulated_bench_has_nothing_to_listen_to():
    with pytest.raises(BadInputError) as caught:
        monitor(MonitorRequest(sim_bench()))
    assert "hil bench sim" in caught.value.fix


def test_senseless_times_are_refused():
    with pytest.raises(BadInputError, match="--every is 0"):
        monitor(MonitorRequest(sim_bench(simulation=None), 0.0))
