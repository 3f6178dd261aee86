"""What holds the bench is killed at random moments with torque on: what bench and recording make of it.

`python -m benchmarks.kills [COUNT]`: `hil sim-bench` in another process in real time, a new one for ten runs.
When torque is at zero is read from the stamps of the RMCU's own frames, which an observer on its bus has
heard: on the stand-in's clock, from the last torque request that it got. What the recording lacks is the time
from its last row to that request. A run that ended before it was killed (a machine that stood still trips the
RMCU, as it should) is tried again; a figure that is too large never is.
"""

from __future__ import annotations

import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hil.core.recording import read_recording
from tests.hil.cli.test_kills import PLAN, REQUEST, STATUS, Observer, holder_of

COUNT, MOST_REPEATS = 100, 30
LARGEST_ZERO_S, LARGEST_LOSS_S = 0.1, 0.5
EARLIEST_S, LATEST_S = 0.3, 4.0  # after torque came
AFTERWARDS_S = 0.4
AT_ONE_STAND_IN = 10
SEED = 13
HIL = Path(sys.executable).with_name("hil")
ON_NM = 5.0


@dataclass(frozen=True)
class Kill:
    """Seconds from the last request to no torque, and of recording that are missing."""

    zero_s: float
    lost_s: float


def main(count: int = COUNT) -> int:
    moments = random.Random(SEED)
    kills: list[Kill] = []
    stalls_s: list[float] = []
    repeats = 0
    load = [os.getloadavg()[0]]
    while len(kills) < count and repeats <= MOST_REPEATS:
        with tempfile.TemporaryDirectory() as folder:
            wanted = min(AT_ONE_STAND_IN, count - len(kills))
            found, stall_s = killed(
                Path(folder), [moments.uniform(EARLIEST_S, LATEST_S) for _ in range(wanted)]
            )
        load.append(os.getloadavg()[0])
        stalls_s.append(stall_s)
        repeats += wanted - len(found)
        kills += found
        for kill in found:
            print(
                f"no torque after {1e3 * kill.zero_s:.0f} ms, {1e3 * kill.lost_s:.0f} ms missing", flush=True
            )
        print(f"{len(kills)}: the stand-in stood still for at most {1e3 * stall_s:.0f} ms", flush=True)
    return told(kills, stalls_s, repeats, load)


def killed(folder: Path, after_s: list[float]) -> tuple[list[Kill], float]:
    """Kills at one stand-in, each so long after the torque came; its longest own stall, s."""
    file = folder / "bench.toml"
    command = [HIL, "sim-bench", "sim", "--port", "0", "--bench-file", file]
    kills = []
    with subprocess.Popen(
        list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as stand_in:
        while not file.exists() and stand_in.poll() is None:
            time.sleep(0.05)
        for moment_s in after_s:
            observer = Observer(tomllib.loads(file.read_text())["buses"]["rmcu"]["channel"])
            try:
                reached = with_run(folder, observer, moment_s)
            finally:
                observer.close()
            if reached:
                kills.append(judged(observer, folder / "out" / "recording.mcap"))
        stand_in.send_signal(signal.SIGINT)
        said = stand_in.communicate()[1]
    stall = re.search(r"the largest (\d+) ms", said)
    return kills, float(stall[1]) / 1e3 if stall else np.nan


def with_run(folder: Path, observer: Observer, after_s: float) -> bool:
    """Start a run, kill it with torque on; False if it ended before."""
    (folder / "long.yaml").write_text(PLAN)
    command = [HIL, "run", "long.yaml", "--bench", folder / "bench.toml", "--out", "out", "--overwrite"]
    with subprocess.Popen(
        list(map(str, command)), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True
    ) as run:
        while observer.torque() < ON_NM:
            if run.poll() is not None:
                return False
            time.sleep(0.05)
        time.sleep(after_s)
        alive = run.poll() is None and observer.torque() > ON_NM
        os.kill(holder_of(run), signal.SIGKILL)
        time.sleep(AFTERWARDS_S)
    return alive


def judged(observer: Observer, path: Path) -> Kill:
    """What the stand-in's frames and the recording say."""
    frames = observer.frames
    asked_s = frames[frames["id"] == REQUEST.id]["time_s"][-1]
    status = frames[frames["id"] == STATUS.id]
    torque = np.array([STATUS.signals["MotorTorqueRef"].value(int(data)) for data in status["data"]])
    on = np.flatnonzero(torque != 0.0)
    if on[-1] + 1 == len(torque):
        return Kill(np.inf, np.inf)  # never at zero
    zero_s = status["time_s"][on[-1] + 1] - asked_s
    recording = read_recording(path, allow_missing=True)
    began_s = recording.time_s[np.flatnonzero(recording["motor_torque_ref_nm"] > ON_NM)[0]]
    kept_s = recording.time_s[-1] - began_s
    until_kill_s = asked_s - status["time_s"][np.flatnonzero(torque > ON_NM)[0]]
    return Kill(float(zero_s), float(until_kill_s - kept_s))


def told(kills: list[Kill], stalls_s: list[float], repeats: int, load: list[float]) -> int:
    """The table; 1 if something took or cost too much."""
    print(f"\n{len(kills)} kills, {repeats} runs ended before and were repeated; ", end="")
    print(f"load average {min(load):.1f} to {max(load):.1f} on {os.cpu_count()} processors\n")
    print("| ms | p50 | p99 | largest | allowed |\n|---|---|---|---|---|")
    for name, seconds, allowed in (
        ("from the last request to no motor torque", [kill.zero_s for kill in kills], LARGEST_ZERO_S),
        ("missing at the end of the recording", [kill.lost_s for kill in kills], LARGEST_LOSS_S),
        (f"longest stall of each of {len(stalls_s)} stand-ins", stalls_s, None),
    ):
        values = 1e3 * np.array(seconds)
        p50, p99 = np.percentile(values, [50, 99])
        limit = "-" if allowed is None else f"{1e3 * allowed:.0f}"
        print(f"| {name} | {p50:.0f} | {p99:.0f} | {values.max():.0f} | {limit} |")
    wrong = sum(kill.zero_s > LARGEST_ZERO_S or kill.lost_s > LARGEST_LOSS_S for kill in kills)
    print(f"\n{len(kills) - wrong} of {len(kills)} within both")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:2])))
