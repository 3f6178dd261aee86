"""The acceptance plan against `hil bench sim` in a second process, beside the figures of virtual time.

`python -m benchmarks.second_process [TIME_SCALE]`: with the stamps as they are, in bursts of 2 ms, and with
single frames stamped up to 50 ms late. Peaks may be 2 % off, band energies 5 %.
"""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from hil.cli.run_output import timing_in_words
from hil.core.result import RunResult
from hil.engine import BenchFile, RunRequest, load_bench, run_plan
from test_plans import load_plan
from tests.late_stamps import late_served_bench

STAMPS = {"as they are": "", "bursts of 2 ms": "bursts", "outliers of 50 ms": "outliers"}
ALLOWED = {"peak_shaft_torque": 0.02, "band_energy_motor_speed": 0.05}
MOST_TRIES = 3  # a machine that stood still trips the RMCU, as it should


def main(time_scale: float = 1.0) -> int:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        true = run_plan(RunRequest(load_plan("acceptance"), load_bench("sim"), out / "virtual")).result
        found = {}
        for name, late in STAMPS.items():
            for attempt in range(MOST_TRIES):
                result = driven(late, time_scale, out / f"{late or 'ideal'}{attempt}")
                print(f"{name}: {result.verdict}, safe state {result.safe_state} {result.reason}".strip())
                for line in timing_in_words(result.timing):
                    print(f"  {line}")
                if result.verdict != "error":
                    break
            found[name] = result
    return printed(true, found)


def driven(late: str, time_scale: float, out: Path) -> RunResult:
    """A run on a bench that another process serves, with its stamps made late."""
    with served(time_scale, out.with_suffix(".toml")) as bench:
        behind = late_served_bench(bench, late) if late else bench
        return run_plan(RunRequest(load_plan("acceptance"), behind, out)).result


@contextlib.contextmanager
def served(time_scale: float, file: Path) -> Iterator[BenchFile]:
    """The bench file of a simulated bench in a process of its own."""
    hil = Path(sys.executable).with_name("hil")
    command = [hil, "bench", "sim", "sim", "--port", "0", "--time-scale", time_scale, "--bench-file", file]
    with subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL) as process:
        while not file.exists() and process.poll() is None:
            time.sleep(0.1)
        yield load_bench(str(file))
        process.send_signal(signal.SIGINT)


def printed(true: RunResult, found: dict[str, RunResult]) -> int:
    """The table; 1 if a figure is further off than it may be, or a run did not pass."""
    wrong = sum(result.verdict not in ("pass", "done") for result in found.values())
    print(f"\n{'':42}{'virtual':>10}" + "".join(f"{name:>26}" for name in found))
    for number, right in enumerate(true.criteria):
        allowed = ALLOWED.get(right.id.partition(".")[2])
        if allowed is None or right.value is None:
            continue
        line = f"{right.id:42}{right.value:10.3f}"
        for result in found.values():
            value = result.criteria[number].value if result.criteria else None
            off = None if value is None else value / right.value - 1
            bad = off is None or abs(off) > allowed
            wrong += bad
            shown = "-" if value is None or off is None else f"{value:.3f} ({off:+.2%})"
            line += f"{shown:>25}{'!' if bad else ' '}"
        print(line)
    print(f"allowed: peaks {ALLOWED['peak_shaft_torque']:.0%}, band energies 5 %; ! is further off")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*map(float, sys.argv[1:2])))
