"""An hour at 1 kHz on the page: how long until its plots are there, and how much of it is sent.

`python -m benchmarks.run_view [SECONDS]`: a recording of twelve channels with one sample that stands out, as
a run of a service. Asked over HTTP as the page asks: the view and the traces of the whole, first when nothing
is kept of it yet, then as it is kept after every run; then the peak closer and closer. Meant: the second in
less than a second.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from pathlib import Path
from urllib.parse import urlencode
from urllib.request import urlopen

import numpy as np
from sqlalchemy import insert

from benchmarks.run_list import a_run
from hil.core.recording import RecordingWriter
from hil.service.store import Base, open_database
from tests.hil.service.served import Served, served

SECONDS, RATE_HZ, MOST_S, PEAK = 3600, 1000, 1.0, 1e4
CHANNELS = [f"channel_{number}_nm" for number in range(12)]
SHOWN = CHANNELS[:6]
_BLOCK = 100_000


def main(seconds: int = SECONDS) -> int:
    """Times and sizes; 1 if opening takes longer than is meant, or the peak is lost."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        runs = folder / "data/runs/000001"
        runs.mkdir(parents=True)
        record(runs / "recording.mcap", seconds)
        size_mb = (runs / "recording.mcap").stat().st_size / 1e6
        engine = open_database(f"sqlite:///{folder / 'data/service.sqlite'}")
        with engine.begin() as connection:
            connection.execute(insert(Base.metadata.tables["runs"]), [a_run(1)])
        engine.dispose()
        with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
            print(f"{seconds} s of {len(CHANNELS)} channels at {RATE_HZ} Hz: {size_mb:.0f} MB")
            _opened(service, "opened first, nothing kept of it", seconds)
        with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
            service.get("/me")
            opened_s, peak = _opened(service, "opened as it is kept after a run", seconds)
            for width_s in (600.0, 60.0, 1.0, 0.1):
                at_s = 0.7 * seconds
                _, found = _asked(
                    service, f"{width_s:g} s around the peak", at_s - width_s / 2, at_s + width_s / 2
                )
                peak = min(peak, found)
            kept_mb = sum(file.stat().st_size for file in (folder / "data/overviews").rglob("*")) / 1e6
        there = "in every view" if peak == PEAK else "LOST"
        print(f"kept beside the recording: {kept_mb:.0f} MB; the peak is {there}")
    return int(opened_s > MOST_S or peak != PEAK)


def record(path: Path, seconds: int) -> None:
    """A recording with one sample that stands out."""
    random = np.random.default_rng(1)
    writer = RecordingWriter(path, ["time_s", *CHANNELS], ["rmcu"])
    for first in range(0, seconds * RATE_HZ, _BLOCK):
        time_s = np.arange(first, min(first + _BLOCK, seconds * RATE_HZ)) / RATE_HZ
        rows = np.column_stack([time_s, random.normal(size=(len(time_s), len(CHANNELS)))])
        rows[np.isclose(time_s, 0.7 * seconds), 1] = PEAK
        writer.add_rows(rows)
    writer.close()


def _opened(service: Served, what: str, seconds: int) -> tuple[float, float]:
    began_s = time.perf_counter()
    service.get("/runs/1/view")
    view_s = time.perf_counter() - began_s
    traces_s, peak = _asked(service, "", -0.1 * seconds, 1.1 * seconds)
    print(f"{what:34} {view_s + traces_s:7.2f} s")
    return view_s + traces_s, peak


def _asked(service: Served, what: str, start_s: float, end_s: float) -> tuple[float, float]:
    query = [*(("channel", name) for name in SHOWN), ("start_s", start_s), ("end_s", end_s), ("most", 1200)]
    began_s = time.perf_counter()
    with urlopen(f"{service.url}/api/v1/runs/1/traces?{urlencode(query)}") as answer:
        text = answer.read()
    took_s = time.perf_counter() - began_s
    found = json.loads(text)
    if what:
        print(
            f"{what:34} {took_s:7.2f} s, {len(text) / 1e3:.0f} kB, buckets of {1e3 * found['width_s']:g} ms"
        )
    return took_s, max(one for one in found["channels"][SHOWN[0]]["highest"] if one is not None)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
