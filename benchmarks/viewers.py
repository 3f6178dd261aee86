"""Fifty viewers of a run that records in real time: does the loop that drives the bench notice them?

`python -m benchmarks.viewers [VIEWERS [TURNS]]`: `hil bench sim` in a process of its own, `hil serve` with
that bench, and runs on it, in turns without viewers and with them. The run's processes have the first
processor; the stand-in shares the second with service and viewers, which are niced. Asked: no sample lost, no
cycle missed, 20 updates a second of twelve channels for each viewer, the 99th percentile of the loop's
lateness at most twice that without them. Cycles that were missed while the processor itself stood still (see
`standstills`) are reported apart.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlencode, urlsplit

import numpy as np
import psutil

from benchmarks.requests import requests_of
from benchmarks.standstills import Standstills, looking
from hil.api_schemas.api import OVER
from hil.core.channels import CHANNELS, TICK_S, TIME
from hil.core.result import PeriodicRequests, RunResult
from tests.hil.cli.test_sim_bench import serving
from tests.hil.service.served import Served, served

VIEWERS, TURNS = 50, 3
WATCHED_CHANNELS = 12  # of each viewer, other ones than those beside it
MOST_TRIES = 3  # a machine that stood still trips the RMCU, as it should
SECONDS = 30
_WATCHED_FROM, _WATCHED_S = 0.2, 20.0  # share of the run, and for how long from there
NICE = 10
_LONGEST_LINE = 1 << 20  # the first has half a minute of twelve channels
_RESTS_S = 0.5  # between two requests: then none was due
PLAN = f"""
name: watched
steps:
  - set_controller: {{file: phase_stabilization.toml}}
  - hold_speed: {{speed_km_h: 0, duration_s: 1}}
  - step: {{segment: s, quantity: driving_torque, from_nm: 0, to_nm: 150, before_s: 2,
           after_s: {SECONDS - 3}}}
finally:
  - ramp_down: {{duration_s: 0.5}}
criteria:
  - {{segment: s, metric: peak_shaft_torque, upper: 1000, unit: N m}}
"""


@dataclass(frozen=True)
class Watched:
    """One run and what its viewers got."""

    viewers: int
    result: RunResult
    updates_per_s: list[float]  # of each viewer, while the run's segment lasted
    busy: float  # of one processor, by the service
    while_still: int  # cycles that were missed while the processor stood still

    @property
    def requests(self) -> tuple[PeriodicRequests, ...]:
        """How each periodic request kept its time."""
        return self.result.timing.requests if self.result.timing else ()

    @property
    def lost(self) -> int:
        """Samples of which no frame came."""
        return sum(clock.lost for clock in self.result.clocks)

    @property
    def missed(self) -> int:
        """Cycles in which no request was sent."""
        return sum(one.missed for one in self.requests)

    @property
    def p99_ms(self) -> float:
        """Of how late requests were sent."""
        return max(one.sent.p99_ms for one in self.requests)


def main(viewers: int = VIEWERS, turns: int = TURNS) -> int:
    """The table; 1 if a figure is not as asked."""
    first, *others = sorted(os.sched_getaffinity(0))
    found: list[Watched] = []
    load = [os.getloadavg()[0]]
    with tempfile.TemporaryDirectory() as name, serving(Path(name)) as (stand_in, file):
        os.sched_setaffinity(stand_in.pid, others or [first])
        folder = Path(name)
        file.write_text(re.sub(r'^name = ".*"', 'name = "bench"', file.read_text(), count=1, flags=re.M))
        with served(folder / "data", "--bench", str(file), state=folder / "state") as service:
            for thread in psutil.Process(service.process.pid).threads():
                os.sched_setaffinity(thread.id, others or [first])
                os.setpriority(os.PRIO_PROCESS, thread.id, NICE)
            service.give("watched", PLAN)
            for _ in range(turns):
                for count in (0, viewers):
                    found.append(_as_it_should(service, count, first))
                    load.append(os.getloadavg()[0])
                    print(_line(found[-1]), flush=True)
    print(f"\nload average {min(load):.1f} to {max(load):.1f} on {1 + len(others)} processors")
    return _judged(found)


def _as_it_should(service: Served, viewers: int, processor: int) -> Watched:
    for _ in range(MOST_TRIES):
        watched = _run(service, viewers, processor)
        if watched.result.verdict == "pass":
            break
        print(f"{viewers} viewers: {watched.result.verdict}, {watched.result.reason}", flush=True)
    return watched


def _run(service: Served, viewers: int, processor: int) -> Watched:
    with _watching(service.url, viewers) as counts, looking(processor) as standstills:
        run = service.queue("watched", "bench")
        service.until(run, lambda one: one["state"] == "running")
        while (one := service.get(f"/runs/{run}"))["state"] not in OVER and (
            one["share"] or 0.0
        ) < _WATCHED_FROM:
            _pin_below(service.process.pid, processor)
            time.sleep(0.2)
        before, begun_s, used_s = list(counts), time.monotonic(), _used_s(service.process.pid)
        time.sleep(_WATCHED_S)
        passed_s = time.monotonic() - begun_s
        rates = [(after - one) / passed_s for after, one in zip(counts, before, strict=True)]
        busy = (_used_s(service.process.pid) - used_s) / passed_s
        service.until(run, lambda one: one["state"] in OVER)
    result = RunResult.model_validate(service.get(f"/runs/{run}/files/result.json"))
    still = _missed_while_still((service.data / f"runs/{run:06d}/recording.mcap").read_bytes(), standstills)
    return Watched(viewers, result, rates, busy, still)


def _missed_while_still(recording: bytes, standstills: Standstills) -> int:
    """Cycles of torque requests that would not have been missed if the processor had not stood still."""
    meant_s, sent_s = requests_of(recording, "RMCU: torque request")
    late = sent_s - meant_s >= TICK_S
    own_s = (sent_s - meant_s - standstills.within(meant_s, sent_s))[late]
    left_out = np.rint(np.diff(meant_s) / TICK_S) - 1
    gaps = np.flatnonzero((left_out > 0) & (left_out * TICK_S < _RESTS_S))
    moving_s = (np.diff(meant_s) - standstills.within(meant_s[:-1], meant_s[1:]))[gaps]
    return int(np.count_nonzero(own_s < TICK_S) + np.sum(left_out[gaps][moving_s < 2 * TICK_S]))


@contextlib.contextmanager
def _watching(url: str, viewers: int) -> Iterator[list[int]]:
    """How many updates with samples each viewer was sent so far; all are one thread's work, and niced."""
    counts, over = [0] * viewers, threading.Event()

    def watch() -> None:
        others = sorted(os.sched_getaffinity(0))[1:]
        os.sched_setaffinity(0, others or os.sched_getaffinity(0))
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)
        asyncio.run(_watch(url, counts, over))

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield counts
    finally:
        over.set()
        thread.join()


async def _watch(url: str, counts: list[int], over: threading.Event) -> None:
    viewers = [asyncio.create_task(_view(url, counts, number)) for number in range(len(counts))]
    while not over.is_set():
        await asyncio.sleep(0.1)
    for viewer in viewers:
        viewer.cancel()
    await asyncio.gather(*viewers, return_exceptions=True)


async def _view(url: str, counts: list[int], number: int) -> None:
    where = urlsplit(url)
    reader, writer = await asyncio.open_connection(where.hostname, where.port, limit=_LONGEST_LINE)
    names = [name for name in CHANNELS if name != TIME]
    chosen = [("channel", names[(number + at) % len(names)]) for at in range(WATCHED_CHANNELS)]
    path = f"/api/v1/benches/bench/live?{urlencode(chosen)}"
    writer.write(f"GET {path} HTTP/1.1\r\nhost: {where.netloc}\r\n\r\n".encode())
    try:
        while line := await reader.readline():
            counts[number] += line == b"event: samples\n"
    finally:
        writer.close()


def _pin_below(pid: int, processor: int) -> None:
    """Have the run's processes, which the service started, on a processor of their own, and not niced."""
    for child in psutil.Process(pid).children(recursive=True):
        with contextlib.suppress(psutil.Error):
            child.cpu_affinity([processor])
            child.nice(0)


def _used_s(pid: int) -> float:
    """Processor time of a process itself, s."""
    used = psutil.Process(pid).cpu_times()
    return float(used.user + used.system)


def _line(one: Watched) -> str:
    p50_ms = max(kind.sent.p50_ms for kind in one.requests)
    largest_ms = max(kind.sent.max_ms for kind in one.requests)
    updates = f"{min(one.updates_per_s):.1f} to {max(one.updates_per_s):.1f}" if one.updates_per_s else "-"
    return (
        f"{one.viewers:3d} viewers: {one.result.verdict}, {one.lost} samples lost, "
        f"{one.missed} cycles missed, {one.while_still} of them while the processor stood still, "
        f"late by {p50_ms:.3f} / {one.p99_ms:.3f} / {largest_ms:.3f} ms (p50, p99, largest), "
        f"{updates} updates a second each, service {one.busy:.0%} of a processor"
    )


def _judged(found: list[Watched]) -> int:
    alone = statistics.median(one.p99_ms for one in found if not one.viewers)
    watched = [one for one in found if one.viewers]
    with_them = statistics.median(one.p99_ms for one in watched)
    least = min(min(one.updates_per_s) for one in watched)
    lost = sum(one.lost for one in watched)
    missed = sum(one.missed - one.while_still for one in watched)
    print(
        f"p99, median of {len(watched)} runs: {alone:.3f} ms alone, {with_them:.3f} ms with viewers "
        f"({with_them / alone:.2f} times, asked: at most 2); {lost} samples lost, "
        f"{missed} cycles missed by the loop, {least:.1f} updates a second at least"
    )
    return int(with_them > 2 * alone or lost > 0 or missed > 0 or least < 19.0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:3])))
