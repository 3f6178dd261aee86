"""Executes one cell of the matrix: `hil run` in a process forked for it, which nothing outlives."""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import select
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

from hil.core.recording._growing_file import GrowingFile
from hil.engine import RunRequest, load_bench, run_plan
from hil.engine.ipc.ipc_messages import Question
from test_plans import load_plan
from tests.benches_for_tests import SIM
from tests.faults.expected import FaultRow, row
from tests.faults.injecting import REQUEST
from tests.faults.stage import BENCH, Injection, Stage
from tests.faults.third_party import ENTRY_POINTS

LONGEST_S = 90.0
PROMPT_AFTER_S = 1.0
AFTERWARDS_S = 0.3  # longer than devices wait for a host
_STEPS = {
    "holding speed": "  - mark: {phase: holding speed}\n  - hold_speed: {speed_km_h: 3, duration_s: 0.5}\n",
    "stepping": "  - mark: {phase: stepping}\n"
    "  - step: {segment: s, quantity: motor_torque, from_nm: 5, to_nm: 20, before_s: 0.2, after_s: 0.7,"
    " load: speed}\n",
    "prompting": "  - mark: {phase: prompting}\n"
    "  - operator_prompt: {text: look at the shafts, timeout_s: 20}\n",
    "analysing": "  - mark: {phase: analysing}\n  - ponder: {how: HOW}\n",
}
_END = "finally:\n  - mark: {phase: ramping down}\n  - ramp_down: {duration_s: 0.5}\n"
_CRITERIA = (
    "criteria:\n  - {segment: s, metric: peak, channel: motor_torque_ref_nm, upper: 30, unit: N m}\n"
    "  - {segment: s, metric: magnitude, channel: shaft_torque_nm, id: s.torque, upper: 400, unit: N m}\n"
    "  - {segment: s, metric: magnitude, channel: wheel_speed_rad_s, id: s.speed, upper: 60, unit: rad/s}\n"
    "  - {segment: s, metric: rows}\n"
)
# Asked twice a second, the panel is missed after 0.6 s
_BESIDE = {
    "": "",
    "panel": '\n[devices.panel]\nkind = "rcs-panel"\nport = "/dev/ttyUSB0"\ngone_after_s = 0.6\n',
    "patient panel": '\n[devices.panel]\nkind = "rcs-panel"\nport = "/dev/ttyUSB0"\n',
    "ram": f'''
[buses.ram]
interface = "hil-sim"
channel = "{BENCH}/ram"
bit_rate = 1000000
[devices.ram]
kind = "ram-xcp"
bus = "ram"
symbols = "A2L"
channels = {{ dfc_torque_nm = "Tm_DFC_ref", wsc_torque_nm = "Tm_WSC_ref", slip_ref = "y_DFC" }}
''',
}


@dataclass(frozen=True)
class Outcome:
    """What became of a cell; times in s of bench time."""

    code: int | None  # None: it hung, or died
    said: str
    counted: int = 0
    injected_s: float | None = None
    ended_s: float = 0.0
    first_torque_s: float = 0.0
    last_torque_s: float = 0.0
    armed: bool = False
    largest_nm: float = 0.0
    result: dict[str, Any] | None = None
    traceback: str = ""

    @property
    def torque_s(self) -> float | None:
        """For how long the RMCU asked for torque after the injection; None: it did not."""
        if self.injected_s is None or self.last_torque_s <= self.injected_s:
            return None
        return self.last_torque_s - max(self.injected_s, self.first_torque_s)


class Operator:
    """Answers every prompt after a second of the bench's time."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._asked_s: float | None = None

    def tell(self, text: str, question: Question | None = None) -> None:
        if "Press Enter" in text:
            self._asked_s = self._stage.now_s

    def typed(self) -> Sequence[str]:
        if self._asked_s is None or self._stage.now_s < self._asked_s + PROMPT_AFTER_S:
            return []
        self._asked_s = None
        return [""]


@contextlib.contextmanager
def prepared(place: Path) -> Iterator[Path]:
    """What all cells share: a package installed, all that is slow to load loaded."""
    installed = place / "packages" / "faults-1.0.dist-info"
    installed.mkdir(parents=True)
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: faults\nVersion: 1.0\n")
    (installed / "entry_points.txt").write_text(ENTRY_POINTS)
    sys.path.insert(0, str(installed.parent))
    try:
        _warm_up(place / "warm")
        yield place
    finally:
        sys.path.remove(str(installed.parent))


def _warm_up(folder: Path) -> None:
    """A run without a fault in this very process: what it loads and compiles, those forked from it have."""
    nothing = row("none", "nothing", Injection)
    folder.mkdir()
    plan, bench = written(nothing, "stepping", folder)
    Stage("stepping", Injection(), REQUEST.id).begin()
    outcome = run_plan(RunRequest(load_plan(str(plan)), load_bench(str(bench)), folder / "out"))
    assert outcome.error is None, outcome.error
    importlib.import_module("hil.app.run")


def execute(fault: FaultRow, phase: str, folder: Path) -> Outcome:
    """The cell's outcome; whatever goes wrong in it stays in its process."""
    folder.mkdir(parents=True)
    sys.stdout.flush()
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        _in_child(fault, phase, folder, writing)
    os.close(writing)
    answer = _read(reading, child)
    _, status = os.waitpid(child, 0)
    said = (folder / "stderr.txt").read_text("utf-8") if (folder / "stderr.txt").exists() else ""
    if not answer:
        return Outcome(None, f"{said} [ended with status {status}]")
    return Outcome(**(json.loads(answer) | {"said": said}))


def _read(reading: int, child: int) -> bytes:
    found, until_s = b"", time.monotonic() + LONGEST_S
    with os.fdopen(reading, "rb", buffering=0) as pipe:
        while True:
            ready, _, _ = select.select([pipe], [], [], max(0.0, until_s - time.monotonic()))
            if not ready:
                os.kill(child, signal.SIGKILL)
                return b""
            data = pipe.read(65536)
            if not data:
                return found
            found += data


def _in_child(fault: FaultRow, phase: str, folder: Path, writing: int) -> None:
    code = 1
    try:
        for number, name in ((1, "stdout.txt"), (2, "stderr.txt")):
            handle = os.open(folder / name, os.O_WRONLY | os.O_CREAT, 0o644)
            os.dup2(handle, number)
        # Whoever ran the tests may have put something else there
        sys.stdout = os.fdopen(1, "w", closefd=False)
        sys.stderr = os.fdopen(2, "w", closefd=False)
        os.environ["HIL_STATE"] = str(folder / "state")
        outcome = _carried_out(fault, phase, folder, reports=phase == "writing")
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        os.write(writing, json.dumps(asdict(outcome)).encode())
        code = 0
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(code)


def _awaited(write: Callable[[GrowingFile, bytes], int]) -> Callable[[GrowingFile, bytes], int]:
    """A disk as quick as the bench: while the thread that writes does so, much bench time would pass."""

    def written(file: GrowingFile, data: bytes) -> int:
        count = write(file, data)
        file.settle()
        return count

    return written


def _carried_out(fault: FaultRow, phase: str, folder: Path, *, reports: bool) -> Outcome:
    command: Any = importlib.import_module("hil.app.run")
    guarded = importlib.import_module("hil.cli._app").guarded

    folder.mkdir(parents=True, exist_ok=True)
    stage = Stage(phase, fault.make(), REQUEST.id)
    terminal: Any = importlib.import_module("hil.cli.output").TERMINAL
    before = command.write_documents
    terminal.terminal = lambda: Operator(stage)
    if not reports:  # they take longer than all the rest
        command.write_documents = lambda *arguments: {}
    stage.begin()
    files = written(fault, phase, folder)
    try:
        with patch.object(GrowingFile, "write", _awaited(GrowingFile.write)):
            code = guarded(
                ["run", str(files[0]), "--bench", str(files[1]), "--out", str(folder / "out"), "--json"]
            )
    finally:
        command.write_documents = before
        del terminal.terminal  # that of the class again
    ended_s = stage.now_s if stage.world is not None else 0.0
    stage.let_time_pass(AFTERWARDS_S)
    result = folder / "out" / "result.json"
    sys.stderr.flush()
    return Outcome(
        code=code,
        said="",
        counted=stage.counted,
        injected_s=stage.injected_s,
        ended_s=ended_s,
        armed=stage.armed,
        first_torque_s=stage.first_torque_s,
        last_torque_s=stage.last_torque_s,
        largest_nm=stage.largest_nm,
        result=json.loads(result.read_text("utf-8")) if result.is_file() else None,
    )


def written(fault: FaultRow, phase: str, folder: Path) -> tuple[Path, Path]:
    """Plan and bench file of a cell."""
    kept = [key for key in _STEPS if key in ("holding speed", "stepping", phase)]
    steps = "".join(_STEPS[key] for key in kept).replace("HOW", fault.ponder)
    plan, bench = folder / "plan.yaml", folder / "bench.toml"
    plan.write_text(f"name: faults\nsteps:\n{steps}{_END}{_CRITERIA}")
    text = SIM.text.replace('"sim"', f'"{BENCH}"', 1).replace('"sim/', f'"{BENCH}/')
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"', f'"{SIM.source.parent / name}"')
    if fault.device:
        text += '\n[devices.oil]\nkind = "oil"\n\n[limits.channels]\noil_temperature_k = {above = 363.0}\n'
    text += _BESIDE[fault.beside].replace("A2L", str(SIM.source.parent / "rmcu.a2l"))
    bench.write_text(text)
    return plan, bench
