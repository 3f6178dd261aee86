"""Executes one cell: three processes in real time, one of which is killed or frozen in one phase."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import threading
import time
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import pytest

from hil.core.errors import HilError
from hil.core.recording import Recording, read_recording, run_of
from hil.core.recording._growing_file import DURABLE_WITHIN_S
from hil.core.result import RunResult
from tests.hil.cli.test_kills import REQUEST, STATUS, Observer, holder_of, is_running
from tests.hil.cli.test_operator_terminal import Operator
from tests.hil.cli.test_sim_bench import serving
from tests.process_faults.disk import DiskWatch
from tests.process_faults.steps import ENTERED, ENTRY_POINTS

ROOT = Path(__file__).parents[2]
#: Phases in their order, and how long after its beginning the fault comes, s.
PHASES = {
    "opening": 0.3,
    "arming": 0.02,
    "holding speed": 0.2,
    "stepping": 0.7,
    "prompting": 0.3,
    "analysing": 0.5,
    "ramping down": 0.2,
    "writing": 0.0,
}
_STEPS = """\
steps:
  - enter: {phase: holding speed}
  - hold_speed: {speed_km_h: 3, duration_s: 0.6}
"""
_OWN = {
    "stepping": "  - enter: {phase: stepping}\n"
    "  - step: {segment: s, quantity: motor_torque, from_nm: 5, to_nm: 20, before_s: 0.3, after_s: 8,"
    " load: speed}\n",
    "prompting": "  - enter: {phase: prompting}\n  - operator_prompt: {text: stand clear, timeout_s: 20}\n",
    "analysing": "  - enter: {phase: analysing}\n  - muse: {for_s: 20}\n",
}
_END = "finally:\n  - enter: {phase: ramping down}\n  - ramp_down: {duration_s: 4}\n"
Run = subprocess.Popen[Any]
_HOST_HEARTBEAT = 0x77F
_LONGEST_S = 90.0
LOST_S = 0.5  # of what was measured may be missing
_AFTERWARDS_S = 0.4


@dataclass(frozen=True)
class Fault:
    """A signal, and whom it hits."""

    title: str
    whom: Literal["holder", "command", "bench"]
    number: int

    @property
    def phases(self) -> tuple[str, ...]:
        """Reports are written by the command, when the process that held the bench has ended."""
        writes = self.whom == "command" and self.number == signal.SIGKILL
        return tuple(phase for phase in PHASES if phase != "writing" or writes)


FAULTS = (
    Fault("the process that holds the bench is killed", "holder", signal.SIGKILL),
    Fault("the process that holds the bench is frozen", "holder", signal.SIGSTOP),
    Fault("the command is killed", "command", signal.SIGKILL),
    Fault("the command is frozen", "command", signal.SIGSTOP),
    Fault("the bench itself is killed", "bench", signal.SIGKILL),
    Fault("the bench itself is frozen", "bench", signal.SIGSTOP),
)


@dataclass(frozen=True)
class Outcome:
    """What became of a cell.

    `torque_s`: from the fault to no torque asked of the inverter; NaN if there was none. `stale_s`: from the
    last request to then. `missing_s`: of what was measured before the fault. `left`: processes that run on.
    """

    code: int
    said: str
    result: RunResult | None
    torque_s: float
    stale_s: float
    missing_s: float
    left: tuple[str, ...]


class Watched(Operator):
    """A command at a terminal that is read all the time: no one waits for the operator's eyes."""

    def __init__(self, folder: Path, text: str, *options: object) -> None:
        super().__init__(folder, text, *options)
        self.out = ""
        self._threads = [threading.Thread(target=self._read), threading.Thread(target=self._take)]
        for thread in self._threads:
            thread.start()

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # no one has the terminal open any more
            while data := os.read(self._own, 4096):
                self.seen += data.decode(errors="replace")
        os.close(self._own)

    def _take(self) -> None:
        assert self.run.stdout is not None
        with self.run.stdout as stdout:
            self.out = stdout.read().decode()

    def left(self) -> int:
        """Its exit code, when all its processes have let go of the terminal."""
        code = self.run.wait(_LONGEST_S)
        for thread in self._threads:
            thread.join(_LONGEST_S)
        return code


@contextlib.contextmanager
def packages(place: Path) -> Iterator[None]:
    """The steps of these tests, as another package brings them."""
    installed = place / "packages" / "process_faults-1.0.dist-info"
    installed.mkdir(parents=True)
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: process_faults\nVersion: 1.0\n")
    (installed / "entry_points.txt").write_text(ENTRY_POINTS)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", f"{ROOT}{os.pathsep}{installed.parent}")
        yield


def execute(fault: Fault, phase: str, folder: Path) -> Outcome | None:
    """The cell's outcome; None if the run did not come as far as its phase, or its disk stood still.

    What is missing was measured, and not written: a disk that keeps another file waiting as long is no
    fault of whoever writes.
    """
    folder.mkdir()
    own = _OWN.get(phase, "")
    text = f"name: processes\n{_STEPS}{own}{_END}"
    with serving(folder) as (bench, file), pytest.MonkeyPatch.context() as patch:
        patch.setenv("HIL_STATE", str(folder / "state"))
        buses = tomllib.loads(file.read_text())["buses"]
        observers = [Observer(buses[name]["channel"]) for name in ("rmcu", "dyno")]
        command = Watched(folder, text, "--bench", file, "--log", folder / "run.log")
        disk = DiskWatch(folder / "disk")
        try:
            done = _hit(fault, phase, folder, command, bench, observers[1])
            code = command.left()
            time.sleep(_AFTERWARDS_S)
        finally:
            disk.close()
            for observer in observers:
                observer.close()
    if done is None:
        return None
    done_s, holder = done
    outcome = _outcome(fault, folder, command, code, done_s, holder, observers[0])
    if outcome.missing_s > LOST_S and disk.longest_s > LOST_S - DURABLE_WITHIN_S:
        return None
    return replace(outcome, missing_s=0.0) if phase == "writing" else outcome  # nothing is measured any more


def _hit(
    fault: Fault,
    phase: str,
    folder: Path,
    command: Watched,
    bench: Run,
    dynos: Observer,
) -> tuple[float, int] | None:
    """Do it; when (s since 1970), and to the run of which process."""
    holder = 0

    def held() -> bool:
        nonlocal holder
        holder = holder or holder_of(command.run)
        return True

    if not (_until(held, command.run) and _until(_begun(phase, folder, dynos), command.run)):
        return None
    time.sleep(PHASES[phase])
    if command.run.poll() is not None:
        return None
    number = {"holder": holder, "command": command.run.pid, "bench": bench.pid}[fault.whom]
    os.kill(number, fault.number)
    done_s = time.time()
    if fault.whom == "command":
        _until(lambda: not is_running(holder), None)
        with contextlib.suppress(ProcessLookupError):
            os.kill(command.run.pid, signal.SIGCONT)
    command.run.wait(_LONGEST_S)
    if fault.whom == "bench" and fault.number == signal.SIGSTOP:
        bench.send_signal(signal.SIGCONT)
    return done_s, holder


def _begun(phase: str, folder: Path, dynos: Observer) -> Callable[[], bool]:
    """Whether a phase has started."""
    if phase == "opening":
        return lambda: True
    if phase == "arming":
        return lambda: bool(np.any(dynos.frames["id"] == _HOST_HEARTBEAT))
    if phase == "writing":
        return lambda: "writing the reports" in (folder / "run.log").read_text()
    return lambda: len(entered(folder, phase)) > 1


def entered(folder: Path, phase: str) -> list[float]:
    """When the phase began, s since 1970: in the rehearsal, in the run."""
    file = folder / f"{phase}{ENTERED}".replace(" ", "-")
    return [float(line) for line in file.read_text().split()] if file.exists() else []


def _until(condition: Callable[[], bool], run: Run | None) -> bool:
    until_s = time.monotonic() + _LONGEST_S
    while time.monotonic() < until_s:
        if condition():
            return True
        if run is not None and run.poll() is not None:
            return False
        time.sleep(0.01)
    return False


def _outcome(
    fault: Fault, folder: Path, command: Watched, code: int, done_s: float, holder: int, rmcu: Observer
) -> Outcome:
    frames = rmcu.frames
    status = frames[frames["id"] == STATUS.id]
    torque = np.array([STATUS.signals["MotorTorqueRef"].value(int(data)) for data in status["data"]])
    on = np.flatnonzero((torque != 0.0) & (status["time_s"] > done_s))
    torque_s = stale_s = np.nan
    if len(on) and fault.whom != "bench":
        gone_s = float(status["time_s"][on[-1] + 1]) if on[-1] + 1 < len(torque) else np.inf
        torque_s = gone_s - done_s
        stale_s = gone_s - float(frames[frames["id"] == REQUEST.id]["time_s"][-1])
    recording = None
    with contextlib.suppress(HilError):  # there is none, or no sample had come
        recording = read_recording(folder / "out" / "recording.mcap", least_samples=0, allow_missing=True)
    left = tuple(
        name for name, number in (("holder", holder), ("command", command.run.pid)) if is_running(number)
    )
    return Outcome(
        code, re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", command.seen), _result(folder, recording),
        torque_s, stale_s, _missing_s(folder, recording, _last_sent_s(status["time_s"], done_s)), left,
    )  # fmt: skip


def _result(folder: Path, recording: Recording | None) -> RunResult | None:
    file = folder / "out" / "result.json"
    if file.exists():
        return RunResult.model_validate_json(file.read_bytes())
    return run_of(recording) if recording is not None else None


def _last_sent_s(stamps_s: npt.NDArray[np.float64], done_s: float) -> float:
    """When the stand-in sent its last sample before the fault: while it stood still there was none."""
    before = stamps_s[stamps_s <= done_s]
    return float(before[-1]) if len(before) else done_s


def _missing_s(folder: Path, recording: Recording | None, sent_s: float) -> float:
    """Rows began before the first phase: those from there to the last that was sent must be there."""
    began = entered(folder, "holding speed")[1:]
    if not began:
        return 0.0
    last_s = float(recording.time_s[-1]) if recording is not None and len(recording.time_s) else 0.0
    return max(0.0, sent_s - began[0] - last_s)
