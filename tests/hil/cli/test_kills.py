"""What is left when a process of two is killed, frozen or asked to stop in the middle of a run.

At a quarter of real time; what the devices did is judged by the stamps of the stand-in's own frames, which an
observer on its buses has heard, never by the clock on the wall.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import threading
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import can
import numpy as np
import pytest

from drivers import read_rmcu
from hil.core.can.frames import SENT_BY_HOST, FrameBlock, joined
from hil.core.recording import Recording, read_recording, run_of
from tests.benches_for_tests import SIM
from tests.hil.cli.test_commands import HIL, hil
from tests.hil.cli.test_sim_bench import serving

TIME_SCALE = 0.25
PLAN = """
name: long
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 2, duration_s: 0.1}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.2, after_s: 8}
finally: [{ramp_down: {duration_s: 0.1}}]
"""
SHORT = PLAN.replace("after_s: 8", "after_s: 0.5")
RMCU = read_rmcu(SIM.rmcu.dbc)
REQUEST, STATUS, CONTROL = (RMCU.layouts[f"RMCU_{name}"] for name in ("Request", "Status", "Control"))
REQUEST_TIMEOUT_S, HEARTBEAT_TIMEOUT_S = 0.05, 0.2
FAULT = 3


class Observer:
    """Somebody else on the RMCU's bus, who writes down what passes there."""

    def __init__(self, channel: str) -> None:
        self._bus = self._opened(channel)
        self._blocks: list[FrameBlock] = []
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()

    def _opened(self, channel: str) -> Any:
        """A bench says where it is just before it answers."""
        for _ in range(20):
            with contextlib.suppress(can.CanError):
                return can.Bus(interface="hil-udp", channel=channel)
        raise AssertionError("the bench does not answer")

    def _listen(self) -> None:
        with contextlib.suppress(can.CanError):  # the bench has been killed
            while not self._done.wait(0.01):
                block = self._bus.recv_epoch_block()
                if len(block):
                    self._blocks.append(block)

    @property
    def frames(self) -> FrameBlock:
        """In order of their stamps, s of the bench's clock since 1970."""
        block = joined(list(self._blocks))
        return block[np.argsort(block["time_s"], kind="stable")]

    def torque(self) -> float:
        """What the RMCU asks of the inverter now, N m."""
        status = self.frames
        status = status[status["id"] == STATUS.id]
        return STATUS.signals["MotorTorqueRef"].value(int(status["data"][-1])) if len(status) else 0.0

    def close(self) -> None:
        self._done.set()
        self._thread.join()
        self._bus.shutdown()


@pytest.fixture
def stand_in(tmp_path: Path) -> Iterator[tuple[Any, Path, Observer]]:
    """A served bench: its process, the bench file, and somebody who listens."""
    with serving(tmp_path, "--time-scale", str(TIME_SCALE)) as (process, file):
        observer = Observer(tomllib.loads(file.read_text())["buses"]["rmcu"]["channel"])
        yield process, file, observer
        observer.close()


def holder_of(run: subprocess.Popen[Any]) -> int:
    """The process that holds the bench for a command."""
    for _ in range(600):
        for child in Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split():
            if b"hil.app.worker.hold" in Path(f"/proc/{child}/cmdline").read_bytes():
                return int(child)
        assert run.poll() is None, run.communicate()
        time.sleep(0.05)
    raise AssertionError("there is none")


def is_running(number: int) -> bool:
    """Whether there is such a process that is more than an entry in a table."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def started(file: Path, folder: Path, text: str = PLAN) -> subprocess.Popen[str]:
    (folder / "long.yaml").write_text(text)
    command = [HIL, "run", "long.yaml", "--bench", file, "--out", "out", "--overwrite", "--json"]
    return subprocess.Popen(
        list(map(str, command)), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def wait_for(condition: Callable[[], bool], run: subprocess.Popen[str]) -> None:
    for _ in range(1200):
        if condition():
            return
        assert run.poll() is None, run.communicate()
        time.sleep(0.05)
    raise AssertionError("did not come so far")


def with_torque_on(stand_in: tuple[Any, Path, Observer], folder: Path) -> subprocess.Popen[str]:
    """A run in the middle of its step, half a second of bench time after the torque came."""
    _, file, observer = stand_in
    run = started(file, folder)
    wait_for(lambda: observer.torque() > 5.0, run)
    time.sleep(0.5 / TIME_SCALE)
    return run


def result_of(run: subprocess.Popen[str], code: int) -> dict[str, Any]:
    out, err = run.communicate(timeout=120)
    assert run.returncode == code, err
    assert "Traceback" not in err
    result: dict[str, Any] = json.loads(out)
    return result | {"said": err}


def readable(folder: Path) -> Recording:
    return read_recording(folder / "out" / "recording.mcap", allow_missing=True)


def assert_verify_tells_a_cut_off_run_from_a_changed_one(out: Path) -> None:
    said = hil("evidence", "verify", out, code=1).stdout
    assert "was changed" not in said
    assert "agrees with what was recorded before the run was cut off" in said
    result = out / "result.json"
    text = result.read_text()
    result.write_text(text.replace('"complete": false', '"complete": true'))
    assert "result.json: was changed: it contradicts" in hil("evidence", "verify", out, code=1).stdout
    result.write_text(text)


def assert_went_to_zero_by_itself(observer: Observer) -> None:
    """After its last request the RMCU waited for its time-out, then asked for no torque any more."""
    frames = observer.frames
    asked = frames[frames["id"] == REQUEST.id]["time_s"][-1]
    control = frames[frames["id"] == CONTROL.id]
    states = np.array([CONTROL.signals["State"].raw(int(data)) for data in control["data"]])
    fell = control["time_s"][np.flatnonzero((states == FAULT) & (control["time_s"] > asked))[0]]
    waited_s = (fell - asked) * TIME_SCALE
    assert REQUEST_TIMEOUT_S - 0.005 <= waited_s <= REQUEST_TIMEOUT_S + 0.02
    status = frames[(frames["id"] == STATUS.id) & (frames["time_s"] > fell + 0.005 / TIME_SCALE)]
    assert not any(STATUS.signals["MotorTorqueRef"].value(int(data)) for data in status["data"])


@pytest.mark.slow
def test_a_stand_in_that_is_killed_ends_the_run_and_the_data_can_be_read(
    stand_in: tuple[Any, Path, Observer], tmp_path: Path
) -> None:
    process, *_ = stand_in
    run = with_torque_on(stand_in, tmp_path)
    process.kill()
    result = result_of(run, 3)
    assert (result["verdict"], result["safe_state"]) == ("error", "not_confirmed")
    assert readable(tmp_path).damage == []
    assert readable(tmp_path)["motor_torque_ref_nm"].max() > 5.0


@pytest.mark.slow
def test_a_run_that_is_killed_leaves_no_torque_and_at_most_half_a_second_is_lost(
    stand_in: tuple[Any, Path, Observer], tmp_path: Path
) -> None:
    _, file, observer = stand_in
    run = with_torque_on(stand_in, tmp_path)
    os.kill(holder_of(run), signal.SIGKILL)
    time.sleep(0.5 / TIME_SCALE)
    result = result_of(run, 3)
    assert "the process that holds the bench: was ended by SIGKILL; safe: confirmed" in result["said"]
    assert (result["verdict"], result["safe_state"]) == ("error", "confirmed")
    assert [segment["complete"] for segment in result["segments"]] == [False]
    assert_went_to_zero_by_itself(observer)
    assert_verify_tells_a_cut_off_run_from_a_changed_one(tmp_path / "out")
    frames = observer.frames
    own = frames[frames["id"] == REQUEST.id]
    recording = readable(tmp_path)
    began = recording["motor_torque_ref_nm"]
    first = np.flatnonzero(began > 5.0)[0]
    seen = frames[frames["id"] == STATUS.id]
    torque = np.array([STATUS.signals["MotorTorqueRef"].value(int(data)) for data in seen["data"]])
    killed_s = (own["time_s"][-1] - seen["time_s"][np.flatnonzero(torque > 5.0)[0]]) * TIME_SCALE
    kept_s = recording.time_s[-1] - recording.time_s[first]
    assert killed_s - kept_s <= 0.5, (killed_s, kept_s)
    assert result_of(started(file, tmp_path, SHORT), 0)["safe_state"] == "confirmed"


@pytest.mark.slow
def test_a_stand_in_that_stands_still_ends_the_run_and_serves_the_next_one(
    stand_in: tuple[Any, Path, Observer], tmp_path: Path
) -> None:
    process, file, _ = stand_in
    run = with_torque_on(stand_in, tmp_path)
    process.send_signal(signal.SIGSTOP)
    result = result_of(run, 3)
    process.send_signal(signal.SIGCONT)
    assert "has stopped coming" in result["said"]
    assert (result["verdict"], result["safe_state"]) == ("error", "not_confirmed")
    time.sleep(1.0 / TIME_SCALE)
    assert result_of(started(file, tmp_path, SHORT), 0)["safe_state"] == "confirmed"


@pytest.mark.slow
def test_a_run_that_stands_still_says_so_and_leaves_the_bench_safe(
    stand_in: tuple[Any, Path, Observer], tmp_path: Path
) -> None:
    _, file, observer = stand_in
    run = with_torque_on(stand_in, tmp_path)
    holder = holder_of(run)
    os.kill(holder, signal.SIGSTOP)
    time.sleep(0.3 / TIME_SCALE)
    assert_went_to_zero_by_itself(observer)
    os.kill(holder, signal.SIGCONT)
    result = result_of(run, 3)
    assert "the bench loop was delayed" in result["said"]
    assert (result["verdict"], result["safe_state"]) == ("error", "confirmed")
    assert result["timing"]["longest_pause_s"] >= 0.25
    assert any(event.kind == "pause" for event in readable(tmp_path).events)
    assert result_of(started(file, tmp_path, SHORT), 0)["safe_state"] == "confirmed"


@pytest.mark.slow
def test_a_run_that_stands_still_for_good_is_ended_and_what_it_measured_is_kept(
    stand_in: tuple[Any, Path, Observer], tmp_path: Path
) -> None:
    _, file, observer = stand_in
    with file.open("a") as bench:
        bench.write("[supervision]\nhung_after_s = 0.5\n")
    run = with_torque_on(stand_in, tmp_path)
    holder = holder_of(run)
    os.kill(holder, signal.SIGSTOP)
    result = result_of(run, 3)
    assert "was stopped (SIGSTOP) for 2." in result["said"]  # 0.5 s of bench time
    assert (result["verdict"], result["safe_state"]) == ("error", "confirmed")
    assert not is_running(holder)
    assert_went_to_zero_by_itself(observer)
    assert readable(tmp_path)["motor_torque_ref_nm"].max() > 5.0


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_a_command_that_is_killed_or_frozen_leaves_a_bench_that_its_process_makes_safe(
    number: int, stand_in: tuple[Any, Path, Observer], tmp_path: Path
) -> None:
    _, file, observer = stand_in
    with file.open("a") as bench:
        bench.write("[supervision]\nalone_after_s = 0.5\n")
    run = with_torque_on(stand_in, tmp_path)
    holder = holder_of(run)
    os.kill(run.pid, number)
    for _ in range(600):
        if not is_running(holder):
            break
        time.sleep(0.05)
    assert observer.torque() == 0.0
    stored = run_of(readable(tmp_path))
    assert stored is not None
    assert (stored.verdict, stored.safe_state) == ("error", "confirmed")
    assert stored.end_steps.startswith("executed: ramp_down")
    words = "the command of this run has ended" if number == signal.SIGKILL else "has been silent for"
    assert words in stored.reason
    if number == signal.SIGSTOP:
        os.kill(run.pid, signal.SIGCONT)
        assert result_of(run, 3)["safe_state"] == "confirmed"
    run.communicate()


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_run_that_is_asked_to_stop_stops_safely(
    number: int, stand_in: tuple[Any, Path, Observer], tmp_path: Path
) -> None:
    _, _, observer = stand_in
    run = with_torque_on(stand_in, tmp_path)
    run.send_signal(number)
    result = result_of(run, 130)
    assert (result["verdict"], result["safe_state"]) == ("error", "confirmed")
    assert observer.torque() == 0.0
    assert not np.any(observer.frames["flags"] & SENT_BY_HOST)
