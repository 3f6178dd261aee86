"""How long an emergency stop takes, from the key to no motor torque.

`python -m benchmarks.emergency_stop [COUNT]`: `hil run` at a pseudo-terminal, `hil bench sim` in another
process in real time; `e` and Enter at random moments with torque on. The key's time is that of the computer,
the rest are stamps of the stand-in's frames; a stand-in that stood still for longer than `LONGEST_STALL_S`
shifts them, and its run is repeated.
"""

from __future__ import annotations

import os
import random
import re
import signal
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.hil.cli.test_kills import PLAN, REQUEST, STATUS, Observer
from tests.hil.cli.test_operator_terminal import Operator
from tests.hil.cli.test_sim_bench import serving

COUNT, MOST_REPEATS = 50, 10
EARLIEST_S, LATEST_S = 0.3, 4.0  # after torque came
LONGEST_STALL_S = 0.1
ON_NM = 5.0
SEED = 15


@dataclass(frozen=True)
class Stop:
    """Seconds from the key to the first request for off, and to no torque."""

    asked_s: float
    zero_s: float


def main(count: int = COUNT) -> int:
    """The table; 1 if a run did not end as it should."""
    moments = random.Random(SEED)
    stops: list[Stop] = []
    repeats = 0
    load = [os.getloadavg()[0]]
    while len(stops) < count and repeats <= MOST_REPEATS:
        with tempfile.TemporaryDirectory() as folder:
            os.environ["HIL_STATE"] = f"{folder}/state"  # a stop is latched: not for the next run
            stop = stopped(Path(folder), moments.uniform(EARLIEST_S, LATEST_S))
        load.append(os.getloadavg()[0])
        repeats += stop is None
        stops += [stop] if stop else []
        print(stop, flush=True)
    print(f"\n{len(stops)} emergency stops, {repeats} runs were repeated; ", end="")
    print(f"load average {min(load):.1f} to {max(load):.1f} on {os.cpu_count()} processors\n")
    print("| ms from the key | p50 | p99 | largest |\n|---|---|---|---|")
    for name, seconds in (
        ("to the first request for off on the bus", [stop.asked_s for stop in stops]),
        ("to no motor torque", [stop.zero_s for stop in stops]),
    ):
        values = 1e3 * np.array(seconds)
        p50, p99 = np.percentile(values, [50, 99])
        print(f"| {name} | {p50:.0f} | {p99:.0f} | {values.max():.0f} |")
    return 0 if len(stops) == count else 1


def stopped(folder: Path, after_s: float) -> Stop | None:
    """One run that is stopped so long after its torque came; None if the machine stood still."""
    with serving(folder) as (stand_in, file):
        observer = Observer(tomllib.loads(file.read_text())["buses"]["rmcu"]["channel"])
        operator = Operator(folder, PLAN, "--bench", file)
        try:
            while observer.torque() < ON_NM:
                if operator.run.poll() is not None:
                    return None
                time.sleep(0.05)
            time.sleep(after_s)
            if observer.torque() < ON_NM:
                return None
            key_s = time.time()
            operator.type("e")
            code, result = operator.ended()
        finally:
            observer.close()
        stand_in.send_signal(signal.SIGINT)
        said = stand_in.communicate()[1]
    stall = re.search(r"the largest (\d+) ms", said)
    assert (code, result["safe_state"]) == (3, "confirmed"), result["reason"]
    assert result["emergency_stop"]["latched"]
    return judged(observer, key_s) if stall and float(stall[1]) < 1e3 * LONGEST_STALL_S else None


def judged(observer: Observer, key_s: float) -> Stop:
    """What the stand-in's frames say."""
    frames = observer.frames
    frames = frames[frames["time_s"] > key_s]
    asked = frames[frames["id"] == REQUEST.id]
    modes = np.array([REQUEST.signals["Mode"].raw(int(data)) for data in asked["data"]])
    status = frames[frames["id"] == STATUS.id]
    torque = np.array([STATUS.signals["MotorTorqueRef"].value(int(data)) for data in status["data"]])
    off_s = asked["time_s"][np.flatnonzero(modes == 0)[0]]
    return Stop(off_s - key_s, status["time_s"][np.flatnonzero(torque != 0.0)[-1] + 1] - key_s)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:2])))
