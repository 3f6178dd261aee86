"""What `hil check acceptance` costs, beside a run of the same plan through frames; processor time."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from hil.core.model import load_model
from hil.engine import RunRequest, load_bench, run_plan
from hil.engine.prediction.forecast import forecast
from hil.engine.prediction.prediction import predict
from test_plans import load_plan

_COMMAND = "import sys; sys.argv[0] = 'hil'; from hil.cli import main; main()"
_IMPORTS = (
    "from hil.app.worker.lean_imports import import_python_can as i; i(); import hil.cli.commands.check"
)


def main() -> None:
    plan, bench = load_plan("acceptance"), load_bench("sim")
    assert bench.simulation is not None
    model = load_model(bench.simulation.model)

    def run() -> None:
        with tempfile.TemporaryDirectory() as directory:
            run_plan(RunRequest(plan, bench, Path(directory)))

    print(f"{'acceptance plan':42}{'cpu s, median of':>20}")
    _show("prediction", 5, _of_this_process(lambda: predict(plan, bench, model)))
    _show("prediction and judging", 5, _of_this_process(lambda: forecast(plan, bench)))
    _show("run through frames, recorded and judged", 3, _of_this_process(run))
    _show("process `hil check acceptance`", 3, lambda: _of_a_process(_COMMAND, "check", "acceptance"))
    _show("of that, its imports", 3, lambda: _of_a_process(_IMPORTS))


def _show(what: str, times: int, measured_s: Callable[[], float]) -> None:
    measured_s()  # compiled kernels and files are in their caches from here on
    print(f"{what:42}{statistics.median(measured_s() for _ in range(times)):17.3f}{times:3d}")


def _of_this_process(work: Callable[[], object]) -> Callable[[], float]:
    def measured_s() -> float:
        start_s = time.process_time()
        work()
        return time.process_time() - start_s

    return measured_s


def _of_a_process(code: str, *arguments: str) -> float:
    """User and system time of a Python process, seconds."""
    script = (
        "import resource, subprocess, sys\n"
        "subprocess.run([sys.executable, '-c', *sys.argv[1:]], check=True, stdout=subprocess.DEVNULL)\n"
        "used = resource.getrusage(resource.RUSAGE_CHILDREN)\n"
        "print(used.ru_utime + used.ru_stime)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, code, *arguments], check=True, capture_output=True, text=True
    )
    return float(done.stdout)


if __name__ == "__main__":
    main()
