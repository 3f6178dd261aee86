"""The page left open while a bench works: memory of page and service over a day's runs.

`python -m benchmarks.open_page [RUNS]` (300): two tabs of a headless Chromium, the bench and the list of
runs, stay open while runs of 60 s on the simulated bench follow each other, as fast as it computes them:
300 of them are what a bench does in a day. Each look is a snapshot of the heap after a garbage collection.
`data` is what the page keeps: objects, arrays, strings, numbers and functions. Apart from it stand the
browser's compiled code, which grows while it warms up, and what its debugger's network log keeps of every
answer, as only a benchmark has. Asked: memory is flat.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from playwright import sync_api as playwright

from benchmarks.soak import memory_mb
from tests.hil.service.served import Served, served

RUNS, LOOKS = 300, 10
_FIRST = 0.2  # of the runs: until then caches fill
_LOOKED_AT = ("data", "code", "nodes", "listeners")
PLAN = """
name: minute
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 39}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 1, after_s: 19}
finally:
  - ramp_down: {duration_s: 1}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}
"""
_DATA = ("object", "array", "string", "concatenated string", "sliced string", "number", "closure", "regexp")
_COUNTED = ("Nodes", "JSEventListeners")


def main(runs: int = RUNS) -> int:
    """Memory after so many runs, and its slope once caches are full."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with served(folder / "data", state=folder / "state") as service, playwright.sync_playwright() as one:
            service.give("minute", PLAN)
            browser = one.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            tabs = [browser.new_page(viewport={"width": 1280, "height": 900}) for _ in range(2)]
            for tab, address in zip(tabs, ("/benches/sim", "/runs"), strict=True):
                tab.goto(service.url + address)
            return _watched(service, tabs, runs)


def _watched(service: Served, tabs: list[playwright.Page], runs: int) -> int:
    asked = [tab.context.new_cdp_session(tab) for tab in tabs]
    for one in asked:
        one.send("Performance.enable")
    print(
        f"{runs} runs of 60 s; bench page and list of runs: data MB, code MB, nodes, listeners; service: MB"
    )
    rows = []
    began_s = time.monotonic()
    for number in range(1, runs + 1):
        service.over(service.queue("minute"))
        if number % max(1, runs // LOOKS) == 0:
            rows.append(
                (float(number), *[value for one in asked for value in _look(one)], _service_mb(service))
            )
            heaps = "   ".join(
                "{:6.3f} {:6.2f} {:6.0f} {:5.0f}".format(*rows[-1][at : at + 4]) for at in (1, 5)
            )
            print(f"{number:4} runs   {heaps}   {rows[-1][-1]:6.0f}", flush=True)
    print(f"{(time.monotonic() - began_s) / 60:.1f} min")
    later = np.array([row for row in rows if row[0] >= _FIRST * runs])
    names = (
        *(f"{what} of the {page}" for page in ("bench page", "list") for what in _LOOKED_AT),
        "service",
    )
    for at, name in enumerate(names, 1):
        slope, error = _slope(later[:, 0], later[:, at])
        print(f"{name:24} {100 * slope:+8.3f} ± {200 * error:.3f} per 100 runs")
    return 0


def _look(session: playwright.CDPSession) -> list[float]:
    """What `_LOOKED_AT` names, of a tab."""
    for _ in range(2):
        session.send("HeapProfiler.collectGarbage")
    sizes = _heap(session)
    seen = {one["name"]: float(one["value"]) for one in session.send("Performance.getMetrics")["metrics"]}
    return [sum(sizes[kind] for kind in _DATA), sizes["code"], *(seen[name] for name in _COUNTED)]


def _heap(session: playwright.CDPSession) -> Counter[str]:
    """Size of what is in a tab's heap by its kind, MB."""
    parts: list[str] = []

    def take(event: dict[str, Any]) -> None:
        parts.append(event["chunk"])

    session.on("HeapProfiler.addHeapSnapshotChunk", take)
    session.send("HeapProfiler.takeHeapSnapshot", {"reportProgress": False})
    session.remove_listener("HeapProfiler.addHeapSnapshotChunk", take)
    found = json.loads("".join(parts))
    fields, kinds = (found["snapshot"]["meta"][name] for name in ("node_fields", "node_types"))
    nodes = np.array(found["nodes"]).reshape(-1, len(fields))
    sizes = np.bincount(nodes[:, fields.index("type")], nodes[:, fields.index("self_size")])
    return Counter({kind: float(size) / 1e6 for kind, size in zip(kinds[0], sizes, strict=False)})


def _service_mb(service: Served) -> float:
    """Resident memory of the service and the processes that it keeps."""
    first = service.process.pid
    kept = Path(f"/proc/{first}/task/{first}/children").read_text().split()
    return memory_mb(first) + sum(memory_mb(int(one)) for one in kept)


def _slope(at: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Of a straight line, with its standard error."""
    line, covariance = np.polyfit(at, values, 1, cov=True)
    return float(line[0]), float(np.sqrt(covariance[0, 0]))


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
