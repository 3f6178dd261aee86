"""The list of ten thousand runs: how long the service takes for a page of it, filtered and sorted.

`python -m benchmarks.run_list [RUNS]`: runs of six plans on three benches with sixteen criteria each in
SQLite, then `hil serve` on them, asked over HTTP as the page asks. Meant: less than 200 ms.
"""

from __future__ import annotations

import datetime
import statistics
import sys
import tempfile
import time
from pathlib import Path
from urllib.parse import urlencode

import numpy as np
from sqlalchemy import insert

from hil.service.store import Base, open_database
from tests.hil.service.served import Served, served

RUNS, CRITERIA, TURNS, MOST_MS = 10_000, 16, 20, 200.0
_VERDICTS = ("pass", "pass", "pass", "fail", "error")
_BEGAN = datetime.datetime(2025, 1, 1, tzinfo=datetime.UTC)
ASKED: dict[str, dict[str, object]] = {
    "newest": {},
    "last page": {"first": RUNS - 50},
    "by plan": {"plan": "plan-3"},
    "failed, of a bench": {"verdict": "fail", "bench": "bench-1"},
    "by device, oldest first": {"sort": "dut", "rising": "true"},
    "by end": {"sort": "ended"},
    "of a month": {"since": "2025-03-01T00:00:00Z", "until": "2025-04-01T00:00:00Z"},
    "by words": {"text": "axle-017"},
    "by a criterion's value": {"criterion": "s3.peak_shaft_torque", "sort": "value"},
    "a criterion's value above": {"criterion": "s3.peak_shaft_torque", "above": 380, "plan": "plan-3"},
}


def main(runs: int = RUNS) -> int:
    """A line for each kind of question; 1 if one takes longer than is meant."""
    slow = False
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "data").mkdir()
        fill(folder / "data/service.sqlite", runs)
        with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
            for _ in range(TURNS):  # a service that has just begun still reads and checks its folder
                service.get("/me")
            print(f"{runs} runs with {CRITERIA} criteria each, SQLite, pages of 50, {TURNS} times, ms")
            print(f"{'':32}  found   median  largest")
            for what, query in ASKED.items():
                found, times_ms = _asked(service, f"/run-list?{urlencode(query)}")
                print(f"{what:32} {found:6} {statistics.median(times_ms):8.1f} {max(times_ms):8.1f}")
                slow |= max(times_ms) > MOST_MS
            _, times_ms = _asked(service, "/run-list/choices")
            print(f"{'choices for filters':39} {statistics.median(times_ms):8.1f} {max(times_ms):8.1f}")
            slow |= max(times_ms) > MOST_MS
    return int(slow)


def _asked(service: Served, path: str) -> tuple[int, list[float]]:
    times_ms, found = [], {}
    for _ in range(TURNS):
        began_s = time.perf_counter()
        found = service.get(path)
        times_ms.append(1e3 * (time.perf_counter() - began_s))
    return found.get("total", 0), times_ms


def fill(file: Path, runs: int) -> None:
    """Runs that have ended, with their criteria, in a new database."""
    engine = open_database(f"sqlite:///{file}")
    random, tables = np.random.default_rng(1), Base.metadata.tables
    with engine.begin() as connection:
        for first in range(1, runs + 1, 1000):
            numbers = range(first, min(first + 1000, runs + 1))
            connection.execute(insert(tables["runs"]), [a_run(number) for number in numbers])
            connection.execute(
                insert(tables["criteria"]),
                [
                    _criterion(number, at, float(random.normal(350, 15)))
                    for number in numbers
                    for at in range(CRITERIA)
                ],
            )
    engine.dispose()


def a_run(number: int) -> dict[str, object]:
    """Columns of a run that has ended."""
    ended = _BEGAN + datetime.timedelta(hours=number)
    return {
        "id": number,
        "plan": f"plan-{number % 6}",
        "title": f"Vibration suppression, variant {number % 6}",
        "plan_text": "steps: []\n" * 200,
        "plan_source": "plan.yaml",
        "bench": f"bench-{number % 3}",
        "state": "ended",
        "values_json": "{}",
        "priority": 0,
        "hazard": "",
        "confirmed_by": "",
        "accept_expired": "",
        "requested_by": ("night", "day", "ci")[number % 3],
        "approved_by": "",
        "queued_at": ended - datetime.timedelta(minutes=10),
        "started_at": ended - datetime.timedelta(minutes=5),
        "ended_at": ended,
        "exit_code": 0,
        "verdict": _VERDICTS[number % 5],
        "safe_state": "confirmed",
        "reason": "",
        "dut": _dut(number),
    }


def _criterion(run: int, at: int, value: float) -> dict[str, object]:
    return {
        "run": run,
        "id": f"s{at}.peak_shaft_torque",
        "value": value,
        "unit": "N m",
        "upper": 400.0,
        "lower": None,
        "verdict": "pass" if value <= 400.0 else "fail",
        "dut": _dut(run),
    }


def _dut(run: int) -> str:
    return f"axle-{run % 40:03}"


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
