"""What is left when the process that held the hardware is lost: its recording, and whether the bench is safe.

Safety is checked over new connections; nothing is sent.
"""

from __future__ import annotations

import logging
from contextlib import ExitStack
from pathlib import Path
from typing import TypeAlias

from drivers import BusLoop, Device, SaysPowerless
from hil.core.errors import HilError
from hil.core.recording import Recording, read_recording, run_of
from hil.core.result import CriterionResult, RunResult, SafeState, verdict_of
from hil.engine.bench.bench import bench_clock, connections_of, open_wire
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.ipc.ipc import RunRequest
from test_plans import judge

Identity: TypeAlias = tuple[int, int]

logger = logging.getLogger(__name__)


def identity_of(path: Path) -> Identity | None:
    """What tells a file from an earlier one of its name; None if there is none."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_ctime_ns


def recording_left(path: Path, before: Identity | None) -> Recording | None:
    """What was recorded; None if nothing was, or if the file is still the one that was there before."""
    if identity_of(path) in (None, before):
        return None
    try:
        return read_recording(path, least_samples=0, allow_missing=True)
    except HilError as error:
        logger.warning("the recording cannot be read: %s", error)
        return None


def result_left(recording: Recording, request: RunRequest, safe: SafeState, error: HilError) -> RunResult:
    """The result of a run that was cut off: whole segments are judged."""
    plan, bench = request.plan, request.bench
    result = RunResult(
        verdict="error", plan=plan.name, bench=bench.name, real_time_factor=0.0, bench_time_s=0.0,
        safe_state=safe,
    )  # fmt: skip
    criteria: tuple[CriterionResult, ...] = ()
    try:
        result = run_of(recording) or result
        criteria = judge(plan, recording, result.segments)
    except Exception:  # what became of the bench is reported all the same
        logger.exception("the recording cannot be evaluated")
    changes = {
        "plan": plan.name,
        "bench": bench.name,
        "criteria": criteria,
        "verdict": verdict_of(criteria, stopped=True),
        "safe_state": safe,
        "reason": str(error),
    }
    return result.model_copy(update=changes)


#: RMCU (50 ms) and dynos (200 ms) have switched themselves off by then; s of the bench's clock.
LISTEN_S = 1.5
_CHUNK_S = 0.02


def complaints_of(file: BenchFile) -> list[str]:
    """Which devices do not say that they give no torque, and why; empty: all say so.

    A device without a bus is not asked: opening its port would touch it.
    """
    found: dict[str, str] = {}
    with ExitStack() as opened:
        try:
            clock, offset_s = bench_clock(file, None, opened)
            wires = []
            for name in file.buses:
                try:
                    wires.append(open_wire(file, name, clock, offset_s, opened, listen_only=True))
                except HilError as error:
                    found[f"bus '{name}'"] = error.what
            loop = BusLoop(clock, wires)
            devices = _devices(file, loop, found)
            _listen(loop, devices, found)
        except Exception as error:  # a device's own code; then nothing is known
            found["the bench"] = f"{type(error).__name__}: {error}"
    return [f"{name}: {why}" for name, why in found.items()]


def _devices(file: BenchFile, loop: BusLoop, found: dict[str, str]) -> list[Device]:
    connections = connections_of(file, loop)
    devices = []
    for key, table in file.device_tables.items():
        bus = getattr(table, "bus", None)
        if bus in connections.wires:
            devices.append(table.open(key.removeprefix("devices."), connections))
        elif bus is None:
            found[key] = "was not read, because opening its port would affect it"
        else:
            found[key] = "sends nothing"
    return devices


def _listen(loop: BusLoop, devices: list[Device], found: dict[str, str]) -> None:
    waiting = list(devices)
    until_s = loop.clock.now_s() + LISTEN_S
    while waiting and loop.clock.now_s() < until_s:
        try:
            loop.run_for(_CHUNK_S)
        except HilError as error:
            found[error.where or "bus"] = error.what
            break
        waiting = [device for device in waiting if not _is_powerless(device)]
    for device in waiting:
        text = "; ".join(dict.fromkeys(device.troubles()))
        found[device.name] = f"does not confirm that its torque is off{f' ({text})' if text else ''}"


def _is_powerless(device: Device) -> bool:
    return device.is_powerless() if isinstance(device, SaysPowerless) else device.is_safe()
