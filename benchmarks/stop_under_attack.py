"""How long an emergency stop over the service takes while something holds the service up.

`python -m benchmarks.stop_under_attack [COUNT [WORD]]`: `hil serve` with a bench in another process in real
time, `hil.client` that asks for a stop at random moments with torque on, COUNT times under each attack, or
under those that have WORD in their names. The answer
is timed here; the torque by the stamps of the stand-in's frames, from the moment of asking. Beside it, how
late a thread of this process wakes up that only sleeps: what the machine itself adds.
"""

from __future__ import annotations

import contextlib
import os
import random
import re
import sys
import tempfile
import threading
import time
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hil.client import Client
from tests.hil.cli.test_kills import STATUS, Observer
from tests.hil.cli.test_sim_bench import serving
from tests.hil.service import attacks
from tests.hil.service.served import RefusedError, Served, served

COUNT = 10
SEED = 41
ON_NM = 5.0
_EARLIEST_S, _LATEST_S = 0.2, 2.0
_WITHIN_S = 120.0
_NAP_S = 0.005
PLAN = """
name: attacked
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 2, duration_s: 0.1}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.2, after_s: 60}
finally: [{ramp_down: {duration_s: 0.1}}]
"""


@dataclass
class Stops:
    """Seconds from asking to the answer, and to no torque; `late_s`: of the thread that only sleeps."""

    answered_s: list[float] = field(default_factory=list)
    zero_s: list[float] = field(default_factory=list)
    late_s: list[float] = field(default_factory=list)


@contextlib.contextmanager
def nothing(service: Served) -> Iterator[None]:
    """No attack."""
    del service
    yield


@contextlib.contextmanager
def both_flooded(service: Served) -> Iterator[None]:
    """Half-open connections to the API and to the stop post."""
    stop_url = service.get("/health")["stop_url"]
    with attacks.half_open(service), attacks.half_open(service, at=stop_url):
        yield


ATTACKS: dict[str, tuple[attacks.Attack, int | None]] = {
    "none": (nothing, None),
    "1,100 half-open connections": (attacks.half_open, None),
    "the same, and 1,100 to the stop post": (both_flooded, None),
    "1,100 half-open connections, `ulimit -n 256`": (attacks.half_open, 256),
    "a model with a key of 40,000 parts, put again and again": (attacks.hostile_model, None),
    "a plan of 240 kB, put again and again": (attacks.hostile_plan, None),
    "a locked SQLite": (attacks.locked_database, None),
}


def main(count: int = COUNT, word: str = "") -> int:
    """The table."""
    moments = random.Random(SEED)
    load = [os.getloadavg()[0]]
    print("| attack | answered: p50 | p99 | largest | no torque: p50 | p99 | largest | a sleeper: p99 |")
    print("|---|---|---|---|---|---|---|---|")
    for name, (attack, descriptors) in ATTACKS.items():
        if word not in name:
            continue
        print(_row(name, stopped(attack, descriptors, count, moments)), flush=True)
        load.append(os.getloadavg()[0])
    print(f"\nms; {count} stops each; load average {min(load):.1f} to {max(load):.1f}, ", end="")
    print(f"{os.cpu_count()} processors")
    return 0


def stopped(attack: attacks.Attack, descriptors: int | None, count: int, moments: random.Random) -> Stops:
    """So many runs that are stopped under an attack, on one service."""
    found = Stops()
    limit: tuple[str, ...] = ()
    if descriptors is not None:
        limit = ("sh", "-c", f'ulimit -n {descriptors}; exec "$@"', "sh")
    with tempfile.TemporaryDirectory() as name, serving(Path(name)) as (_, file):
        folder = Path(name)
        file.write_text(re.sub(r'^name = ".*"', 'name = "bench"', file.read_text(), count=1, flags=re.M))
        channel = tomllib.loads(file.read_text())["buses"]["rmcu"]["channel"]
        arguments = ("--bench", str(file), "--rate", "1000")
        with served(folder / "data", *arguments, state=folder / "state", through=limit) as service:
            service.give("attacked", PLAN)
            client = Client(service.url)
            client.find_stop_post()
            for _ in range(count):
                _stop_one(service, client, channel, attack, moments.uniform(_EARLIEST_S, _LATEST_S), found)
    return found


def _stop_one(
    service: Served, client: Client, channel: str, attack: attacks.Attack, after_s: float, found: Stops
) -> None:
    observer = Observer(channel)
    try:
        run = service.queue("attacked", "bench")
        _until(lambda: observer.torque() >= ON_NM, service, run)
        with attack(service), _sleeper(found):
            time.sleep(after_s)
            asked_s, began_s = time.time(), time.monotonic()
            client.stop_in_emergency("bench")
            found.answered_s.append(time.monotonic() - began_s)
            _until(lambda: observer.torque() == 0.0, service, run)
        found.zero_s.append(_zero_s(observer) - asked_s)
        _until(lambda: _is_reset(service, run), service, run)
    finally:
        observer.close()


def _zero_s(observer: Observer) -> float:
    """When the motor's torque was zero for good, by the stand-in's stamps."""
    status = observer.frames
    status = status[status["id"] == STATUS.id]
    torque = np.array([STATUS.signals["MotorTorqueRef"].value(int(data)) for data in status["data"]])
    return float(status["time_s"][np.flatnonzero(torque != 0.0)[-1] + 1])


@contextlib.contextmanager
def _sleeper(found: Stops) -> Iterator[None]:
    ended = threading.Event()

    def sleep() -> None:
        while not ended.is_set():
            before_s = time.monotonic()
            time.sleep(_NAP_S)
            found.late_s.append(time.monotonic() - before_s - _NAP_S)

    thread = threading.Thread(target=sleep)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def _is_reset(service: Served, run: int) -> bool:
    """Once the run is over; a database that was locked is away for a second more."""
    with contextlib.suppress(RefusedError):
        service.over(run)
        service.post("/benches/bench/reset")
        return True
    return False


def _until(condition: Callable[[], bool], service: Served, run: int) -> None:
    until_s = time.monotonic() + _WITHIN_S
    while not condition():
        if time.monotonic() > until_s:
            raise TimeoutError(f"did not come so far: {service.get(f'/runs/{run}')}")
        time.sleep(0.01)


def _row(name: str, stops: Stops) -> str:
    cells = [name]
    for seconds in (stops.answered_s, stops.zero_s):
        values = 1e3 * np.array(seconds)
        p50, p99 = np.percentile(values, [50, 99])
        cells += [f"{p50:.0f}", f"{p99:.0f}", f"{values.max():.0f}"]
    cells.append(f"{1e3 * float(np.percentile(stops.late_s, 99)):.0f}")
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if sys.argv[1:] else COUNT, *sys.argv[2:3]))
