"""Processes of a run are killed or frozen at random moments with torque on: what bench and data make of it.

`python -m benchmarks.kills [COUNT [OTHERS]]`: COUNT times the process that holds the bench is killed, OTHERS
times each other fault is tried. `hil bench sim` is another process in real time, a new one for ten runs. When
torque is at zero is read from the stamps of the RMCU's own frames, which an observer on its bus has heard: on
the stand-in's clock. A run that ended before (a machine that stood still trips the RMCU, as it should) is
tried again; a figure that is too large never is.
"""

from __future__ import annotations

import datetime
import json
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
from typing import Literal

import numpy as np

from hil.core.recording import read_recording, run_of
from tests.hil.cli.test_kills import PLAN, REQUEST, STATUS, Observer, holder_of, is_running

COUNT, OTHERS, MOST_REPEATS = 100, 10, 30
LARGEST_ZERO_S, LARGEST_LOSS_S = 0.1, 0.5
STALE_S = 0.02  # what is sent later than this after the fault comes from something that outlived its loop
#: `hung_after_s` and `alone_after_s` of a bench file that does not name them, s.
NOTICED_S = 2.0
EARLIEST_S, LATEST_S = 0.3, 4.0  # after torque came
AFTERWARDS_S = 0.4
AT_ONE_STAND_IN = 10
SEED = 13
HIL = Path(sys.executable).with_name("hil")
ON_NM = 5.0

Run = subprocess.Popen[str]


@dataclass(frozen=True)
class Fault:
    """A signal and whom it hits; `told`: words of the command's log that say so."""

    title: str
    number: int
    whom: Literal["holder", "command", "stand-in"]
    told: str = ""

    def pid(self, run: Run, stand_in: Run) -> int:
        return {"holder": holder_of(run), "command": run.pid, "stand-in": stand_in.pid}[self.whom]

    @property
    def largest_zero_s(self) -> float:
        """Until torque is gone: from the last request, or from the fault if another process has to see it."""
        frozen = self.whom == "command" and self.number == signal.SIGSTOP
        return LARGEST_ZERO_S + (NOTICED_S if frozen else 0.0)


FAULTS = (
    Fault("the process that holds the bench is killed", signal.SIGKILL, "holder", "was ended by SIGKILL"),
    Fault("the process that holds the bench is frozen", signal.SIGSTOP, "holder", "not running|stopped"),
    Fault("the command is killed", signal.SIGKILL, "command"),
    Fault("the command is frozen", signal.SIGSTOP, "command"),
    Fault("the bench is killed", signal.SIGKILL, "stand-in"),
)


@dataclass(frozen=True)
class Moment:
    """What one fault led to, s: until no torque (NaN: no one was left to tell), of recording that is missing,
    until the command said so (NaN: it did not live to), and from the fault to the last request.

    `wrong`: what is not as it should be, in words.
    """

    zero_s: float
    lost_s: float
    told_s: float = np.nan
    last_request_s: float = np.nan
    wrong: str = ""


def main(count: int = COUNT, others: int = OTHERS) -> int:
    """The tables; 1 if something took or cost too much."""
    wrong = 0
    for fault in FAULTS:
        moments, stalls_s, repeats, load = tried(fault, count if fault is FAULTS[0] else others)
        if moments:
            wrong += told(fault, moments, stalls_s, repeats, load)
    return 1 if wrong else 0


def tried(fault: Fault, count: int) -> tuple[list[Moment], list[float], int, list[float]]:
    """The moments, stalls of the stand-ins, how many runs were repeated, the machine's load."""
    random_ = random.Random(SEED)
    moments: list[Moment] = []
    stalls_s: list[float] = []
    repeats = 0
    load = [os.getloadavg()[0]]
    at_one = 1 if fault.whom == "stand-in" else AT_ONE_STAND_IN
    while len(moments) < count and repeats <= MOST_REPEATS:
        with tempfile.TemporaryDirectory() as folder:
            wanted = min(at_one, count - len(moments))
            after_s = [random_.uniform(EARLIEST_S, LATEST_S) for _ in range(wanted)]
            found, stall_s = at_a_stand_in(fault, Path(folder), after_s)
        load.append(os.getloadavg()[0])
        stalls_s.append(stall_s)
        repeats += wanted - len(found)
        moments += found
        for moment in found:
            print(f"{fault.title}: {moment}", flush=True)
    return moments, stalls_s, repeats, load


def at_a_stand_in(fault: Fault, folder: Path, after_s: list[float]) -> tuple[list[Moment], float]:
    """The fault at one stand-in, each time so long after the torque came; its longest own stall, s."""
    file = folder / "bench.toml"
    command = [HIL, "bench", "sim", "sim", "--port", "0", "--bench-file", file]
    moments = []
    with subprocess.Popen(
        list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as stand_in:
        while not file.exists() and stand_in.poll() is None:
            time.sleep(0.05)
        for moment_s in after_s:
            observer = Observer(tomllib.loads(file.read_text())["buses"]["rmcu"]["channel"])
            try:
                moment = with_run(fault, folder, observer, stand_in, moment_s)
            finally:
                observer.close()
            moments += [moment] if moment else []
        stand_in.send_signal(signal.SIGINT)
        said = stand_in.communicate()[1]
    stall = re.search(r"the largest (\d+) ms", said)
    return moments, float(stall[1]) / 1e3 if stall else np.nan


def with_run(fault: Fault, folder: Path, observer: Observer, stand_in: Run, after_s: float) -> Moment | None:
    """Start a run and do it to it with torque on; None if it ended before."""
    (folder / "long.yaml").write_text(PLAN)
    command = [HIL, "run", "long.yaml", "--bench", folder / "bench.toml", "--out", "out", "--overwrite",
               "--log", "run.log"]  # fmt: skip
    with subprocess.Popen(
        list(map(str, command)), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True
    ) as run:
        while observer.torque() < ON_NM:
            if run.poll() is not None:
                return None
            time.sleep(0.05)
        time.sleep(after_s)
        if run.poll() is not None or observer.torque() <= ON_NM:
            return None
        holder = holder_of(run)
        os.kill(fault.pid(run, stand_in), fault.number)
        done_s = time.time()
        if fault.whom == "command" and fault.number == signal.SIGSTOP:
            while is_running(holder):
                time.sleep(0.05)
            run.send_signal(signal.SIGCONT)
        run.wait()
        while is_running(holder):
            time.sleep(0.05)
        time.sleep(AFTERWARDS_S)
    return judged(fault, observer, folder, done_s, run.returncode)


def judged(fault: Fault, observer: Observer, folder: Path, done_s: float, code: int) -> Moment:
    """What the stand-in's frames, the recording and the run say."""
    frames = observer.frames
    asked_s = frames[frames["id"] == REQUEST.id]["time_s"]
    status = frames[frames["id"] == STATUS.id]
    torque = np.array([STATUS.signals["MotorTorqueRef"].value(int(data)) for data in status["data"]])
    on = np.flatnonzero(torque != 0.0)
    gone = on[-1] + 1 < len(torque)
    since_s = done_s if fault.whom == "command" else asked_s[-1]
    zero_s = float(status["time_s"][on[-1] + 1] - since_s) if gone else np.inf
    if fault.whom == "stand-in":  # no one is left to tell
        zero_s = np.nan
    recording = read_recording(folder / "out" / "recording.mcap", allow_missing=True)
    began_s = recording.time_s[np.flatnonzero(recording["motor_torque_ref_nm"] > ON_NM)[0]]
    first_s = status["time_s"][np.flatnonzero(torque > ON_NM)[0]]
    lost_s = float(min(done_s, asked_s[-1]) - first_s - (recording.time_s[-1] - began_s))
    last_request_s = float(asked_s[-1] - done_s)
    wrong = [
        f"{text}: {value_s:.3f} s"
        for text, value_s, most_s in (
            ("torque", zero_s, fault.largest_zero_s),
            ("missing", lost_s, LARGEST_LOSS_S),
            ("requests after the fault", last_request_s, np.inf if fault.whom == "command" else STALE_S),
        )
        if value_s > most_s
    ]
    told_s = said_after(folder / "run.log", fault.told, done_s)
    wrong += _wrong_words(fault, folder, code)
    return Moment(zero_s, max(0.0, lost_s), told_s, last_request_s, "; ".join(wrong))


def _wrong_words(fault: Fault, folder: Path, code: int) -> list[str]:
    """What the run said that is not right."""
    killed = fault.whom == "command" and fault.number == signal.SIGKILL
    right = "not_confirmed" if fault.whom == "stand-in" else "confirmed"
    found = [] if code == (-signal.SIGKILL if killed else 3) else [f"exit code {code}"]
    if killed:
        stored = run_of(read_recording(folder / "out" / "recording.mcap", allow_missing=True))
        safe = stored.safe_state if stored else "no run"
    else:
        safe = json.loads((folder / "out" / "result.json").read_text())["safe_state"]
    return found if safe == right else [*found, f"safe state {safe}"]


def said_after(log: Path, words: str, since_s: float) -> float:
    """How long after a moment (s since 1970) the log says one of `words`, s; NaN if it does not."""
    for line in log.read_text().splitlines():
        if words and " ERROR hil.engine.process.supervisor" in line and re.search(words, line):
            said = datetime.datetime.strptime(line[:23], "%Y-%m-%d %H:%M:%S,%f")
            return said.timestamp() - since_s
    return np.nan


def told(fault: Fault, moments: list[Moment], stalls_s: list[float], repeats: int, load: list[float]) -> int:
    """The table of one fault; how many moments are wrong."""
    print(
        f"\n## {fault.title}: {len(moments)} times\n\n{repeats} runs ended before and were repeated; ", end=""
    )
    print(f"load average {min(load):.1f} to {max(load):.1f} on {os.cpu_count()} processors\n")
    print("| ms | p50 | p99 | largest | allowed |\n|---|---|---|---|---|")
    since = "from the fault" if fault.whom == "command" else "from the last request"
    rows = (
        (f"{since} to no motor torque", [m.zero_s for m in moments], fault.largest_zero_s),
        ("from the fault to the last request", [m.last_request_s for m in moments], None),
        ("from the fault to the command's word", [m.told_s for m in moments], None),
        ("missing at the end of the recording", [m.lost_s for m in moments], LARGEST_LOSS_S),
        (f"longest stall of each of {len(stalls_s)} stand-ins", stalls_s, None),
    )
    for name, seconds, allowed in rows:
        values = 1e3 * np.array(seconds)
        values = values[~np.isnan(values)]
        if len(values):
            p50, p99 = np.percentile(values, [50, 99])
            limit = "-" if allowed is None else f"{1e3 * allowed:.0f}"
            print(f"| {name} | {p50:.0f} | {p99:.0f} | {values.max():.0f} | {limit} |")
    wrong = [moment.wrong for moment in moments if moment.wrong]
    print(f"\n{len(moments) - len(wrong)} of {len(moments)} as they should be", *wrong, sep="\n- ")
    return len(wrong)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:3])))
