"""How many times faster than real time the acceptance plan runs, through real frames, on one core."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from hil.core.recording import read_frames
from hil.engine import RunRequest, load_bench, run_plan
from test_plans import load_plan


def main() -> None:
    print(
        f"{'':12}{'bench time s':>14}{'wall s':>9}{'cpu s':>9}{'x real time':>13}{'frames':>10}{'us each':>9}"
    )
    for attempt in ("first", "second", "third"):
        with tempfile.TemporaryDirectory() as directory:
            wall, cpu = time.perf_counter(), time.process_time()
            outcome = run_plan(RunRequest(load_plan("acceptance"), load_bench("sim"), Path(directory)))
            wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
            count = sum(len(block) for block in read_frames(outcome.recording).values())
        result = outcome.result
        each = result.bench_time_s / result.real_time_factor / count * 1e6
        print(
            f"{attempt:12}{result.bench_time_s:14.1f}{wall:9.2f}{cpu:9.2f}{result.real_time_factor:13.1f}"
            f"{count:10d}{each:9.2f}"
        )


if __name__ == "__main__":
    main()
