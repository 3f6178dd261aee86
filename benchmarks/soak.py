"""Hours of bench time in virtual time: memory, time, file size, and what the recording takes afterwards.

`python -m benchmarks.soak [HOURS]` (10): `hil run` in a process of its own, whose memory is looked at every
few seconds; then `hil export`, `hil report`, `hil evidence verify` and `hil diagnose` of the recording, each
with its time and its largest memory. Only what was run is printed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from hil.core.channels import TIME
from hil.core.recording import read_recording
from hil.engine.run.preflight import needed_bytes
from test_plans import load_plan

HOURS, HOUR_S, LOOK_S = 10.0, 3600.0, 5.0
ROUND_S = 600.0  # a hold and a step
HIL = Path(sys.executable).with_name("hil")
STEP = "quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 1, after_s: 19"
LARGEST_GROWTH_MB = 300.0  # rows are kept up to 256 MB, then they are read from the file


def main(hours: float = HOURS) -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "soak.yaml"
        file.write_text(plan_of(hours))
        out = folder / "out"
        memory = watched([HIL, "run", file, "--out", out], out / "recording.mcap")
        return told(hours, folder, memory)


def plan_of(hours: float) -> str:
    """Rounds of ten minutes: a speed is held, a torque step played."""
    rounds = round(hours * HOUR_S / ROUND_S)
    steps = ["  - set_controller: {file: phase_stabilization.toml}"]
    for number in range(rounds):
        steps.append(f"  - hold_speed: {{speed_km_h: 10, duration_s: {ROUND_S - 20:g}}}")
        steps.append(f"  - step: {{segment: s{number}, {STEP}}}")
    criterion = f"  - {{segment: s{rounds - 1}, metric: peak_shaft_torque, upper: 400, unit: N m}}"
    return "\n".join(
        ["name: soak", "steps:", *steps, "finally: [{ramp_down: {duration_s: 1}}]", "criteria:", criterion]
    )


def watched(command: list[str | Path], grows: Path) -> list[tuple[float, float]]:
    """MB of the file and of the process's memory, again and again, until it ends."""
    found = []
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while process.poll() is None:
            time.sleep(LOOK_S)
            size = grows.stat().st_size / 1e6 if grows.exists() else 0.0
            found.append((size, memory_mb(process.pid)))
    print(f"{' '.join(map(str, command[:2]))}: exit code {process.returncode}")
    return [look for look in found if look[1]]


def memory_mb(process: int) -> float:
    """Resident memory now; 0 if it has ended."""
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return next((float(line.split()[1]) / 1e3 for line in lines if line.startswith("VmRSS")), 0.0)


def told(hours: float, folder: Path, memory: list[tuple[float, float]]) -> int:
    """What came of it; 1 if memory grew, time drifted or the file is larger than was predicted."""
    path = folder / "out" / "recording.mcap"
    size, predicted = path.stat().st_size, needed_bytes(load_plan(str(folder / "soak.yaml")))
    result = json.loads((folder / "out" / "result.json").read_text())
    growing = [look for look in memory if 0.1 * size / 1e6 < look[0] < 0.99 * size / 1e6]
    print(f"{hours:g} h of bench time at {result['real_time_factor']} times real time: {result['verdict']}")
    print(
        "recording / memory, MB: "
        + ", ".join(f"{a:.0f} / {b:.0f}" for a, b in growing[:: max(1, len(growing) // 10)])
    )
    largest = max((mb for _, mb in memory), default=0.0)
    print(f"the run, judging and reports at its end included: at most {largest:.0f} MB of memory")
    recording = read_recording(path)
    model = folder / "model.toml"
    model.write_bytes(recording.attachments[model.name])
    off_s = max(
        float(np.max(np.abs(rows[TIME] - 1e-3 * (first + np.arange(len(rows[TIME]))))))
        for first, rows in recording.blocks((TIME,))
    )
    lasted_s = result["bench_time_s"]
    print(f"{recording.samples} samples, off their millisecond by at most {off_s:.2g} s, over {lasted_s} s")
    print(f"file {size / 1e6:.0f} MB, predicted with its reports at most {predicted / 1e6:.0f} MB")
    after: list[list[str | Path]] = [
        ["export", path, "--out", folder / "r.parquet"],
        ["report", path, "--out", folder / "again"],
        ["evidence", "verify", folder / "out"],
        ["diagnose", path, "--model", model, "--out", folder / "diagnosis"],
    ]
    for arguments in after:
        began_s = time.monotonic()
        most_mb = largest_mb([HIL, *arguments])
        print(f"hil {arguments[0]}: {most_mb:.0f} MB, {time.monotonic() - began_s:.0f} s", flush=True)
    grown = max(b for _, b in growing) - growing[0][1] if growing else 0.0
    return int(grown > LARGEST_GROWTH_MB or off_s > 1e-6 or size > predicted)


def largest_mb(command: list[str | Path]) -> float:
    """Largest resident memory of a process."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, command
    return usage.ru_maxrss / 1e3


if __name__ == "__main__":
    sys.exit(main(*map(float, sys.argv[1:2])))
