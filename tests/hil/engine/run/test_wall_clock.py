"""The path of a bench with hardware: wall clock, ordinary python-can buses, frames one by one.

The simulated bench runs in a thread of its own, in real time, at the other end of python-can's
in-process virtual buses.
"""

import contextlib
import gc
import subprocess
import sys
import threading
import time

import can
import numpy as np
import pytest
from mcap.reader import make_reader

from hil.core.errors import BenchError, InterruptError
from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.core.runtime.clock import undisturbed
from hil.engine import RunRequest, run_plan
from sim_backend.bench import SimulatedBench, SimulationSettings
from tests.benches_for_tests import SIM, plan
from tests.hil.cli.test_sim_bench import serving
from tests.operators import Silent, Slow

STEPS = """
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 5, duration_s: 0.2}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.2, after_s: 0.8}
"""
HOST_HEARTBEAT = 0x77F
LONGEST_STALL_S = 0.03  # the RMCU takes its torque away after 50 ms without a request
MOST_REPEATS = 5
CRITERIA = "[{segment: s, metric: peak_shaft_torque, lower: 90, upper: 200}]"


@contextlib.contextmanager
def bench_in_real_time(name):
    """A simulated bench behind `virtual` buses.

    Gives the bench file, an event that cuts its power, and a list of the stalls (s) that it saw: its own, and
    those of the host, whose heartbeat comes every 50 ms.
    """
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    world.sleep_until(0.01)  # what is compiled is compiled before time counts
    for bus in SIM.buses:
        world.take(bus)
    ends = {
        bus: can.Bus(interface="virtual", channel=f"{name}/{bus}", preserve_timestamps=True)
        for bus in SIM.buses
    }
    stop, unplugged, stalls = threading.Event(), threading.Event(), []
    epoch = time.time() - world.now_s()

    def serve():
        with undisturbed(collections=True):  # as the run at the other end
            look_and_send()

    def look_and_send():
        last, beat = time.monotonic(), None
        while not stop.is_set():
            now = time.monotonic()
            stalls.append(now - last)
            last = now
            world.sleep_until(time.time() - epoch)
            for bus, end in ends.items():
                while (message := end.recv(0)) is not None:
                    if message.arbitration_id == HOST_HEARTBEAT:
                        stalls.append(0.0 if beat is None else now - beat - 0.05)
                        beat = now
                    world.put(bus, message.arbitration_id, bytes(message.data))
                for frame in world.take(bus):
                    if not unplugged.is_set():
                        end.send(message_of(frame, epoch))
            time.sleep(0.001)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        buses = {
            bus: settings.model_copy(
                update={
                    "interface": "virtual",
                    "channel": f"{name}/{bus}",
                    "options": {"preserve_timestamps": True},
                }
            )
            for bus, settings in SIM.buses.items()
        }
        yield SIM.model_copy(update={"name": name, "buses": buses, "simulation": None}), unplugged, stalls
    finally:
        stop.set()
        thread.join()
        for end in ends.values():
            end.shutdown()


def message_of(frame, epoch):
    data = int(frame["data"]).to_bytes(8, "little")[: int(frame["length"])]
    return can.Message(
        timestamp=epoch + float(frame["time_s"]),
        arbitration_id=int(frame["id"]),
        is_extended_id=False,
        data=data,
    )


def ran_in_real_time(name, request, ends=None):
    """The outcome of what `request` asks of a bench, ended by an error of the kind `ends` if there is one.

    `request` is given the bench file, and an event that cuts the bench's power. A run that does not end as
    meant is run again if the machine stood still: that trips the RMCU, as it should.
    """
    meant = ends or type(None)
    for attempt in range(MOST_REPEATS):
        with bench_in_real_time(f"{name}{attempt}") as (bench, unplugged, stalls):
            outcome = run_plan(request(bench, unplugged))
        if type(outcome.error) is meant or max(stalls) < LONGEST_STALL_S:
            break
    assert type(outcome.error) is meant, (outcome.error, max(stalls))
    return outcome


def test_a_run_in_real_time_records_and_judges_like_one_in_virtual_time(tmp_path):
    outcome = ran_in_real_time("wall", lambda bench, _: RunRequest(plan(STEPS, CRITERIA), bench, tmp_path))
    assert (outcome.result.verdict, outcome.result.safe_state) == ("pass", "confirmed")
    recording = read_recording(outcome.recording)
    assert recording.metadata["run"]["simulated"] == "false"
    np.testing.assert_allclose(np.diff(recording.time_s), 1e-3)
    sides = recording["shaft_torque_left_nm"] + recording["shaft_torque_right_nm"]
    np.testing.assert_allclose(recording["shaft_torque_nm"], sides)


def test_a_bench_that_loses_power_ends_the_run_and_is_not_called_safe(tmp_path):
    def cut(bench, unplugged):
        request = RunRequest(plan(STEPS, CRITERIA), bench, tmp_path)
        request.progress = lambda share, text: unplugged.set() if share > 0.3 else None
        return request

    outcome = ran_in_real_time("power", cut, ends=BenchError)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "not_confirmed")


def test_heartbeats_go_on_while_the_operator_is_asked(tmp_path):
    steps = "[{hold_speed: {speed_km_h: 2, duration_s: 0.1}}, {operator_prompt: {text: look}}]"
    outcome = ran_in_real_time(
        "asked", lambda bench, _: RunRequest(plan(steps), bench, tmp_path, terminal=Slow(0.5))
    )
    assert outcome.result.safe_state == "confirmed"


def test_an_interrupt_does_not_wait_for_an_answer_of_the_operator(tmp_path):
    def interrupted(bench, _):
        request = RunRequest(plan("[{operator_prompt: {text: look}}]"), bench, tmp_path)
        request.terminal = Silent(then=lambda text: request.stop.ask())
        return request

    outcome = ran_in_real_time("unanswered", interrupted, ends=InterruptError)
    assert outcome.result.safe_state == "confirmed"


@pytest.mark.slow
def test_nothing_is_compiled_or_loaded_once_devices_watch_their_host(tmp_path):
    """In a process of its own: in this one other tests have made all ready."""
    with serving(tmp_path, "--time-scale", "0.25") as (_, file):
        command = [sys.executable, "-m", "tests.hil.engine.ready_when_armed", str(file)]
        done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == ""


def test_each_request_is_timed_and_nothing_collected_while_they_are_sent(tmp_path):
    collected = []

    def watched(bench, _):
        request = RunRequest(plan(STEPS, CRITERIA), bench, tmp_path)
        request.progress = lambda share, text: collected.append((text, gc.isenabled()))
        return request

    outcome = ran_in_real_time("timed", watched)
    timing = outcome.result.timing
    assert timing.clock == "wall"
    by_name = {request.request: request for request in timing.requests}
    assert 0 < by_name["torque request"].count <= 1200
    assert by_name["torque request"].sent.max_ms >= by_name["torque request"].sent.p50_ms >= 0
    assert by_name["heartbeat"].period_s == 0.05
    assert ("coming up", True) in collected
    assert ("s", False) in collected
    with outcome.recording.open("rb") as file:
        stored = [message.data for *_, message in make_reader(file).iter_messages(topics=["/requests"])]
    torque = [data for data in stored if data[2:].startswith(b"RMCU: torque request")]
    assert sum(len(data) for data in torque) >= by_name["torque request"].count * 24
