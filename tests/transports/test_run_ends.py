"""A run on a bus that fails ends in plain words and, where the bus still carries frames, confirmed safe."""

from __future__ import annotations

import contextlib
import threading

import pytest

from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.engine import RunRequest, run_plan
from sim_backend.bench import SimulatedBench, SimulationSettings
from sim_backend.serving import BenchServer, SlcanPort
from tests.benches_for_tests import SIM, plan

MOST_REPEATS = 5
LONGEST_STALL_S = 0.03  # the RMCU takes its torque away after 50 ms without a request
TIME_SCALE = 0.5
STEPS = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 2, duration_s: 0.2}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 50, before_s: 0.2, after_s: 2.5}
"""


@contextlib.contextmanager
def served_on_terminals():
    """A bench file whose buses are slcan adapters, the adapters, and the server."""
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    ports = {name: SlcanPort(bus.bit_rate) for name, bus in SIM.buses.items()}
    server, stop = BenchServer(world, ports, TIME_SCALE), threading.Event()
    thread = threading.Thread(target=server.serve, args=[stop.is_set])
    thread.start()
    try:
        buses = {name: bus.model_copy(update=ports[name].table) for name, bus in SIM.buses.items()}
        yield (
            SIM.model_copy(update={"buses": buses, "simulation": None, "time_scale": TIME_SCALE}),
            ports,
            server,
        )
    finally:
        stop.set()
        thread.join()
        for port in ports.values():
            with contextlib.suppress(OSError):
                port.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "said"),
    [("sb000255", "bus-off"), ("sp000130", "error-passive"), ("\a", "the transmit queue is full")],
)
@pytest.mark.parametrize("bus", ["rmcu", "dyno"])
def test_what_an_adapter_says_of_its_bus_ends_the_run_safely(bus, line, said, tmp_path):
    for attempt in range(MOST_REPEATS):
        with served_on_terminals() as (bench, ports, server):
            request = RunRequest(plan(STEPS), bench, tmp_path / str(attempt))
            told: list[float] = []

            def fail(share, text, told=told, ports=ports):
                if share > 0.4 and not told:
                    told.append(share)
                    ports[bus].say(line)

            request.progress = fail
            outcome = run_plan(request)
        if said in str(outcome.error) or server.pace.largest_stall_s < LONGEST_STALL_S:
            break  # only a machine that stood still may be asked again
    assert f"bus '{bus}': {said}" in str(outcome.error)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "confirmed")


def test_remarks_stand_in_the_recording(tmp_path):
    """A warning ends nothing, and is not forgotten."""
    with served_on_terminals() as (bench, ports, _):
        request = RunRequest(plan("[{wait: {duration_s: 0.7}}]"), bench, tmp_path)
        request.progress = lambda share, text: ports["dyno"].say("sw100100")
        outcome = run_plan(request)
    recording = read_recording(outcome.recording, least_samples=0, allow_missing=True)
    events = [event.text for event in recording.events if event.kind == "bus"]
    assert events == ["dyno: error warning: 96 errors or more were counted"]
