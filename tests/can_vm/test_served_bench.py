"""Real frames on emulated controllers: `hil bench sim` at one end, a run and others' tools at the other.

Inside of the machine that `make test-can-vm` boots, with everything ten times slower than real time: its
processor is that much slower. Time-outs are scaled alike. simcan0 and simcan1 are two controllers on the bus
of the RMCU, simcan2 and simcan3 on the dynos'; the bench is at the odd ones.
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

from hil.core.channels import TICK_S
from hil.core.recording import read_frames, read_recording
from hil.engine import BenchFile, RunOutcome, RunRequest, load_bench, run_plan
from tests.benches_for_tests import SIM, plan
from tests.can_vm.interfaces import ip, plugged_in, unplugged, up
from tests.can_vm.plans import BOTH_CONTROLLERS, CRITERIA, LONG_STEP

INSIDE = "HIL_CAN_VM_INSIDE" in os.environ
TIME_SCALE = 0.1
MISSED_AT_MOST = 0.03  # share of cycles: the processor has 5 million instructions for each, for both ends
#: Where the machine that emulates this one is busy, the emulated controllers overrun: the run is repeated.
MOST_TRIES = 3
STARTS_WITHIN_S = 400
FIGURES = Path("/mnt/out/figures.json")  # of the same plan in virtual time, from outside
HIL = str(Path(sys.executable).with_name("hil"))

pytestmark = [
    pytest.mark.skipif(not INSIDE, reason="no emulated CAN controllers here: make test-can-vm has them"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BenchFile]:
    """The bench file of a simulated bench in another process, on the odd controllers."""
    file = tmp_path_factory.mktemp("served") / "net.toml"
    command = [HIL, "bench", "sim", "sim", "--transport", "socketcan", "--time-scale", str(TIME_SCALE),
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
    time.sleep(5.0)  # it has just started, and catches up
    command = ["candump", "-t", "a", "-n", "1500", "simcan0"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
    frames = re.findall(r"\(([\d.]+)\)\s+simcan0\s+([0-9A-F]+)", shown)
    assert {frame for _, frame in frames} >= {"110", "111", "200"}
    stamps = np.array([float(stamp) for stamp, frame in frames if frame == "110"])
    print(f"\nstatus frames: {np.percentile(np.diff(stamps) * 1e3, [1, 50, 99]).round(2)} ms apart")
    assert np.mean(np.diff(stamps)) == pytest.approx(TICK_S / served.time_scale, rel=0.1)


def test_a_run_passes_with_the_figures_of_virtual_time(served: BenchFile, tmp_path: Path) -> None:
    figures = json.loads(FIGURES.read_text())
    for attempt in range(MOST_TRIES):
        outcome = carried_out(served, BOTH_CONTROLLERS, tmp_path / f"real{attempt}", CRITERIA)
        assert outcome.error is None
        lost = sum(clock.lost for clock in outcome.result.clocks)
        print(f"{lost} samples lost")
        if not lost:
            break
    assert lost == 0
    reasons = [found.reason for found in outcome.result.criteria if found.reason]
    assert (outcome.result.verdict, outcome.result.safe_state) == ("pass", "confirmed"), reasons
    for found in outcome.result.criteria:
        if found.source != "plan":  # kept, or the run had not passed; what is left of T_s is mostly noise
            continue
        print(f"{found.id}: {found.value} ({figures[found.id]})")
        assert found.value == pytest.approx(figures[found.id], rel=0.02)
    timing = outcome.result.timing
    assert timing is not None
    torque = next(request for request in timing.requests if request.request == "torque request")
    assert torque.seen is not None
    assert torque.unseen <= 0.001 * torque.count
    assert torque.missed <= MISSED_AT_MOST * torque.count
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


def test_a_controller_that_is_unplugged_ends_the_run(served: BenchFile, tmp_path: Path) -> None:
    request = RunRequest(plan(LONG_STEP), served, tmp_path)
    done: list[float] = []

    def unplug(share: float, text: str) -> None:
        if text == "s" and not done:
            done.append(share)
            unplugged("simcan2")

    request.progress = unplug
    outcome = run_plan(request)
    print(f"\n{outcome.error}", flush=True)
    assert done
    plugged_in("simcan2")
    said = str(outcome.error)
    assert "the adapter is gone" in said or "the network interface is down" in said
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "not_confirmed")
