"""The speed of a motor is heard without a frame of ours, where no adapter would acknowledge frames."""

import json
import os
import subprocess
import threading

import pytest

from hil.app.worker.motor_speed import MOTOR_SPEED, heard, why_never
from hil.core.errors import BenchError
from hil.core.model import load_model
from hil.engine.bench.bench_lock import alone_on
from sim_backend.bench import SimulatedBench, SimulationSettings
from sim_backend.serving import BenchServer, UdpHub
from tests.benches_for_tests import SIM, sim_bench
from tests.drivers.pseudo_adapter import plugged_in


def on_buses(interface: str, **channels: object):
    """The bench of tests on buses of an interface."""
    buses = {
        name: bus.model_copy(update={"interface": interface, "channel": channels.get(name, bus.channel)})
        for name, bus in SIM.buses.items()
    }
    return sim_bench("served", buses=buses, simulation=None)


@pytest.fixture
def served():
    """A simulated bench in a thread, and the bench file that connects to it."""
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    hubs = {name: UdpHub(0, 1_000_000, 1.0) for name in SIM.buses}
    server, ended = BenchServer(world, hubs), threading.Event()
    thread = threading.Thread(target=server.serve, args=(ended.is_set,))
    thread.start()
    yield on_buses("hil-udp", **{name: hub.table["channel"] for name, hub in hubs.items()}), server
    ended.set()
    thread.join()
    server.close()


def test_a_speed_is_heard_and_nothing_sent(served) -> None:
    bench, server = served
    found = heard(bench)
    assert abs(float(str(found["speed_rad_s"]))) < 0.2  # it stands
    assert [received for _, received in server.frames.values()] == [0, 0]


def test_a_bench_that_another_process_drives_is_left_alone(served) -> None:
    bench, _ = served
    with alone_on(bench), pytest.raises(BenchError, match="in use"):
        heard(bench)


def test_a_silent_rmcu_says_so() -> None:
    with plugged_in() as rmcu, plugged_in() as dyno:
        found = heard(on_buses("slcan", rmcu=rmcu.path, dyno=dyno.path))
        assert not [line for line in rmcu.heard() if line.startswith("t")]  # no frame
    assert found == {"why": "the RMCU sent no speed within 0.5 s"}


@pytest.mark.parametrize(
    ("interface", "why"),
    [("ixxat", "the adapter of bus 'rmcu' (ixxat) would acknowledge frames when it is opened"),
     ("socketcan", ""), ("pcan", ""), ("hil-udp", "")],
)  # fmt: skip
def test_an_adapter_that_acknowledges_is_never_opened(interface: str, why: str) -> None:
    assert why_never(on_buses(interface)) == why


@pytest.mark.slow
def test_of_a_simulated_bench_there_is_nothing_to_hear() -> None:
    program = subprocess.run(
        [*MOTOR_SPEED, "sim"], stdout=subprocess.PIPE, check=True, env={**os.environ, "PYTHONWARNINGS": ""}
    )
    why = "the bench is simulated, and exists during a run only"
    assert json.loads(program.stdout) == {"why": why, "final": True}
