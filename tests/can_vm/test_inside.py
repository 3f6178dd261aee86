"""Real frames on emulated controllers: `hil sim-bench` at one end, a run and others' tools at the other.

Inside of the machine that `make test-can-vm` boots, with everything ten times slower than real time: an
emulated processor is that much slower; more where it has to share a real one. Time-outs are scaled alike.
simcan0 and simcan1 are two controllers on the RMCU's bus, simcan2 and simcan3 on the dynos'; the bench is at
the odd ones.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import can
import numpy as np
import pytest

from hil.core.conventions import TICK_S
from hil.core.model import load_model
from hil.core.recording import read_frames, read_recording
from hil.engine import BenchFile, RunOutcome, RunRequest, load_bench, run_plan
from sim_backend.bench import SimulatedBench, SimulationSettings
from tests.benches_for_tests import SIM, plan
from tests.can_vm.at_the_limit import recorded
from tests.can_vm.plans import BOTH_CONTROLLERS, CRITERIA, LONG_STEP

INSIDE = "HIL_CAN_VM_INSIDE" in os.environ
TIME_SCALES = (0.1, 0.05, 0.03)
BUSY_AT_MOST = 0.3  # share of a processor for what the bench computes; sockets cost more than as much again
STARTS_WITHIN_S = 400
FIGURES = Path("/mnt/out/figures.json")  # of the same plan in virtual time, from outside
HIL = str(Path(sys.executable).with_name("hil"))

pytestmark = [
    pytest.mark.skipif(not INSIDE, reason="no emulated CAN controllers here: make test-can-vm has them"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


def ip(*arguments: str) -> None:
    subprocess.run(["ip", "link", "set", *arguments], check=True)


def up(name: str) -> None:
    ip(name, "up", "txqueuelen", "500", "type", "can", "bitrate", "1000000")


def time_scale() -> float:
    """As fast as the simulated bench can be computed here, with room."""
    world = SimulatedBench(SimulationSettings(load_model(SIM.simulation.model), SIM.rmcu.dbc, SIM.dyno.eds))
    turns, began = 300, 0.0
    for turn in range(-turns, turns):
        began = time.monotonic() if turn == 0 else began
        world.sleep_until(world.now_s() + TICK_S)
        for bus in SIM.buses:
            world.take(bus)
    possible = BUSY_AT_MOST * turns * TICK_S / (time.monotonic() - began)
    chosen = next((scale for scale in TIME_SCALES if scale <= possible), TIME_SCALES[-1])
    print(f"\n{possible:.3f} of real time is possible, {chosen} is taken", flush=True)
    return chosen


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BenchFile]:
    """The bench file of a simulated bench in another process, on the odd controllers."""
    file = tmp_path_factory.mktemp("served") / "net.toml"
    command = [HIL, "sim-bench", "sim", "--transport", "socketcan", "--time-scale", str(time_scale()),
               "--interface", "simcan1:simcan0", "--interface", "simcan3:simcan2",
               "--bench-file", str(file)]  # fmt: skip
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        end_s = time.monotonic() + STARTS_WITHIN_S
        while not file.exists() and process.poll() is None and time.monotonic() < end_s:
            time.sleep(0.5)
        assert file.exists()
        yield load_bench(str(file))
        process.send_signal(signal.SIGINT)
        process.wait(60)


def carried_out(bench: BenchFile, steps: str, out: Path, criteria: str = "[]") -> RunOutcome:
    outcome = run_plan(RunRequest(plan(steps, criteria), bench, out))
    print(f"\n{outcome.error}\n{outcome.result.timing}", flush=True)
    return outcome


def test_candump_sees_the_devices_at_their_pace(served: BenchFile) -> None:
    time.sleep(5.0)  # it has just begun, and catches up
    command = ["candump", "-t", "a", "-n", "1500", "simcan0"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
    frames = re.findall(r"\(([\d.]+)\)\s+simcan0\s+([0-9A-F]+)", shown)
    assert {frame for _, frame in frames} == {"110", "111", "200"}
    stamps = np.array([float(stamp) for stamp, frame in frames if frame == "110"])
    print(f"\nstatus frames: {np.percentile(np.diff(stamps) * 1e3, [1, 50, 99]).round(2)} ms apart")
    assert np.mean(np.diff(stamps)) == pytest.approx(TICK_S / served.time_scale, rel=0.1)


def test_a_run_passes_with_the_figures_of_virtual_time(served: BenchFile, tmp_path: Path) -> None:
    figures = json.loads(FIGURES.read_text())
    outcome = carried_out(served, BOTH_CONTROLLERS, tmp_path / "real", CRITERIA)
    assert outcome.error is None
    assert (outcome.result.verdict, outcome.result.safe_state) == ("pass", "confirmed")
    assert all(clock.lost == 0 for clock in outcome.result.clocks)
    for found in outcome.result.criteria:
        print(f"{found.id}: {found.value} ({figures[found.id]})")
        assert found.value == pytest.approx(figures[found.id], rel=0.02)
    timing = outcome.result.timing
    assert timing is not None
    torque = next(request for request in timing.requests if request.request == "torque request")
    assert torque.seen is not None
    assert torque.unseen <= 0.001 * torque.count
    assert torque.missed <= 0.01 * torque.count
    frames = read_frames(outcome.recording)
    assert {0x110, 0x111, 0x200, 0x100} <= set(frames["rmcu"]["id"].tolist())


def test_a_bus_that_goes_down_ends_the_run_and_once_it_is_up_the_next_one_works(
    served: BenchFile, tmp_path: Path
) -> None:
    request = RunRequest(plan(LONG_STEP), served, tmp_path / "down")
    done: list[float] = []

    def take_down(share: float, text: str) -> None:
        if text == "s" and not done:
            done.append(share)
            ip("simcan0", "down")

    request.progress = take_down
    outcome = run_plan(request)
    print(f"\n{outcome.error}", flush=True)
    assert done
    up("simcan0")
    assert "the network interface is down" in str(outcome.error)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "not_confirmed")
    assert len(read_recording(outcome.recording, allow_missing=True).time_s) > 100
    time.sleep(1.0)
    assert carried_out(served, "[{wait: {duration_s: 0.3}}]", tmp_path / "up").error is None


def test_python_can_logs_what_cansend_sends_and_reads_it_again(served: BenchFile, tmp_path: Path) -> None:
    file = tmp_path / "bus.asc"
    logger = subprocess.Popen(
        [sys.executable, "-m", "can.logger", "-i", "socketcan", "-c", "simcan0", "-f", str(file)],
        stdout=subprocess.DEVNULL,
    )
    end_s = time.monotonic() + STARTS_WITHIN_S
    while not (file.exists() and file.stat().st_size > 1000) and time.monotonic() < end_s:
        time.sleep(0.5)
    subprocess.run(["cansend", "simcan1", "7DF#0201050000000000"], check=True)
    time.sleep(1.0)
    logger.send_signal(signal.SIGINT)
    logger.wait(60)
    with can.LogReader(str(file)) as reader:
        messages = {message.arbitration_id: bytes(message.data) for message in reader}
    assert messages[0x7DF] == bytes.fromhex("0201050000000000")
    assert {0x110, 0x111, 0x200} <= messages.keys()


def test_a_foreign_canopen_master_finds_the_dynos_and_reads_their_objects(served: BenchFile) -> None:
    import canopen

    network = canopen.Network()
    network.connect(interface="socketcan", channel="simcan2")
    try:
        network.scanner.search(limit=10)
        time.sleep(3.0)
        assert {3, 4} <= set(network.scanner.nodes)
        node = network.add_node(3, str(SIM.dyno.eds))
        node.sdo.RESPONSE_TIMEOUT = 5.0
        assert node.sdo[0x1000].raw & 0xFFFF == 402
        node.nmt.wait_for_heartbeat(timeout=20)
    finally:
        network.disconnect()


def test_a_minute_at_the_limit_of_this_machine_is_recorded_without_a_loss(tmp_path: Path) -> None:
    """The fastest pace of which two seconds are lossless, a fifth slower, for a minute."""
    fastest = None
    for gap_ms in (4.0, 2.0, 1.0, 0.7, 0.5, 0.35, 0.25):
        counted = recorded("simcan0", "simcan1", gap_ms, 2.0, tmp_path / f"{gap_ms}.mcap")
        print(f"\n{counted}")
        if not counted.lossless:
            break
        if fastest is None or counted.rate > fastest:
            fastest = counted.rate
    assert fastest is not None
    minute = recorded("simcan0", "simcan1", 1.25e3 / fastest, 60.0, tmp_path / "minute.mcap")
    print(f"\n60 s: {minute}")
    assert minute.lossless


def test_a_controller_that_is_unplugged_ends_the_run(served: BenchFile, tmp_path: Path) -> None:
    device = Path("/sys/class/net/simcan2/device").resolve()
    request = RunRequest(plan(LONG_STEP), served, tmp_path)
    done: list[float] = []

    def unplug(share: float, text: str) -> None:
        if text == "s" and not done:
            done.append(share)
            (device / "remove").write_text("1")

    request.progress = unplug
    outcome = run_plan(request)
    print(f"\n{outcome.error}", flush=True)
    assert done
    before = {path.name for path in Path("/sys/class/net").iterdir()}
    Path("/sys/bus/pci/rescan").write_text("1")
    time.sleep(2.0)
    (back,) = {path.name for path in Path("/sys/class/net").iterdir()} - before
    ip(back, "name", "simcan2")
    up("simcan2")
    said = str(outcome.error)
    assert "the adapter is gone" in said or "the network interface is down" in said
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "not_confirmed")
