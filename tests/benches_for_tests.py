"""Benches that tests run on: the shipped simulated one, changed where a test says so."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hil.engine import BenchFile, load_bench
from hil.engine.bench.bench import open_bench
from test_plans import Plan, plan_from_text

#: Any: its tables are those of the kinds that the file names.
SIM: Any = load_bench("sim")


def sim_bench(name: str = "test", **changes: Any) -> BenchFile:
    """The simulated bench under a name of its own."""
    buses = {key: bus.model_copy(update={"channel": f"{name}/{key}"}) for key, bus in SIM.buses.items()}
    return SIM.model_copy(update={"name": name, "buses": buses, **changes})


@contextlib.contextmanager
def running(name: str = "test", **changes: Any) -> Iterator[Any]:
    """An open simulated bench with its dynos started."""
    with open_bench(sim_bench(name, **changes)) as bench:
        bench.loop.run_for(0.2)
        bench.start_heartbeats()
        bench.dyno.come_up()
        yield bench


def plan(steps: str, criteria: str = "[]", end: str = "[{ramp_down: {duration_s: 0.1}}]") -> Plan:
    """A plan from YAML snippets."""
    text = f"name: test\nsteps: {steps}\nfinally: {end}\ncriteria: {criteria}\n"
    return plan_from_text(text, "test plan", Path())
