"""A campaign of 10,000 simulations: in one process, on one worker, on two that are killed in the middle.

The first two run side by side, a core for each, so that what else the machine does meets both.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import psutil

HIL = Path(sys.executable).parent / "hil"
CAMPAIGN = """
name: ten_thousand
plan: {plan}
draws: {count}
tolerance:
  vehicle_inertia: 0.1
  tyre_stiffness: 0.2
  tyre_damping: 0.2
  shaft_stiffness: 0.05
  dead_time_s: 0.001
  order_phase: true
  sensor_noise: 1.0
"""

#: Two seconds of bench time with each of two controllers: next to nothing, so that what is around it shows.
SHORT = """
name: short
steps:
  - set_controller: {file: gain_stabilization.toml}
  - step: {segment: gain, STEP}
  - set_controller: {file: phase_stabilization.toml}
  - step: {segment: phase, STEP}
criteria:
  - {segment: gain, metric: peak_shaft_torque, upper: 723, unit: N m}
  - {segment: phase, metric: peak_shaft_torque, upper: 564, unit: N m}
""".replace("STEP", "quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.1, after_s: 0.9")


@dataclass(frozen=True)
class Spent:
    """What a command took: by the clock, and of processors, workers included."""

    clock_s: float
    processor_s: float

    def __add__(self, other: Spent) -> Spent:
        return Spent(self.clock_s + other.clock_s, self.processor_s + other.processor_s)


class Command:
    """`hil campaign` as a process."""

    def __init__(self, file: Path, out: Path, *options: str) -> None:
        self.out, self._begun_s = out, time.monotonic()
        self._process = subprocess.Popen(
            [HIL, "campaign", file, "--out", out, *options], stdout=subprocess.DEVNULL
        )

    def ended(self) -> Spent:
        """Wait for it; children that it waited for count."""
        _, status, used = os.wait4(self._process.pid, 0)
        assert os.waitstatus_to_exitcode(status) == 0
        return Spent(time.monotonic() - self._begun_s, used.ru_utime + used.ru_stime)

    def killed_at(self, share: float, count: int) -> Spent:
        """Kill it, and it alone, once so much of `count` is on disk."""
        while self.done() < share * count:
            time.sleep(0.2)
        whole = psutil.Process(self._process.pid)
        times = [one.cpu_times() for one in (whole, *whole.children(recursive=True))]
        os.kill(self._process.pid, signal.SIGKILL)
        self._process.wait()
        return Spent(time.monotonic() - self._begun_s, sum(one.user + one.system for one in times))

    def done(self) -> int:
        """Simulations on disk."""
        names = [path.stem.split("-") for path in self.out.glob("simulations/part-*.parquet")]
        return sum(int(last) - int(first) + 1 for _, first, last in names)


def table_of(out: Path, count: int) -> pd.DataFrame:
    """The table without times; every number stands in it once."""
    table = pd.read_parquet(out / "simulations").sort_values("simulation", ignore_index=True)
    assert list(table["simulation"]) == list(range(count)), "lost, or done twice"
    return table.drop(columns="processor_s")


def main() -> None:
    asked = argparse.ArgumentParser()
    asked.add_argument("--simulations", type=int, default=10_000)
    asked.add_argument("--short", action="store_true", help="a plan of 2 s in place of acceptance")
    options = asked.parse_args()
    count, plan = options.simulations, "short.yaml" if options.short else "acceptance"
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "short.yaml").write_text(SHORT)
        file = place / "campaign.yaml"
        file.write_text(CAMPAIGN.format(plan=plan, count=count))
        loads = [os.getloadavg()[0]]
        alone, one = (Command(file, place / n, "--workers", n) for n in ("0", "1"))
        spent = {"in one process, without dask": alone.ended(), "1 worker, beside it": one.ended()}
        loads.append(os.getloadavg()[0])
        two = Command(file, place / "2", "--workers", "2")
        first = two.killed_at(0.5, count)
        kept = two.done()
        second = Command(file, place / "2", "--workers", "2", "--resume").ended()
        spent["2 workers, killed (-9) and resumed"] = first + second
        loads.append(os.getloadavg()[0])
        tables = [table_of(place / n, count) for n in ("0", "1", "2")]
        for other in tables[1:]:
            pd.testing.assert_frame_equal(tables[0], other)
    base = spent["in one process, without dask"]
    print(f"{count} simulations of '{plan}', load average {', '.join(f'{load:.1f}' for load in loads)}")
    print(f"{'':<38}{'clock':>9}{'processor':>11}{'efficiency: clock':>20}{'processor':>11}")
    for (name, took), workers in zip(spent.items(), (1, 1, 2), strict=True):
        clock = base.clock_s / took.clock_s / workers
        processor = base.processor_s / took.processor_s
        print(f"{name:<38}{took.clock_s:>7.0f} s{took.processor_s:>9.0f} s{clock:>20.2f}{processor:>11.2f}")
    print(f"killed with {kept} on disk; every simulation stands once, and all three tables are the same")


if __name__ == "__main__":
    main()
