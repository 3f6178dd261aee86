"""Lets everything be compiled that a run and a served bench use, into the cache of the environment."""

from __future__ import annotations

import tempfile
from pathlib import Path

from hil.engine import RunRequest, run_plan
from tests.benches_for_tests import plan
from tests.can_vm.plans import BOTH_CONTROLLERS, CRITERIA
from tests.hil.engine.test_wall_clock import bench_in_real_time


def main() -> None:
    with tempfile.TemporaryDirectory() as folder, bench_in_real_time("compiled") as (bench, _, _):
        run_plan(RunRequest(plan(BOTH_CONTROLLERS, CRITERIA), bench, Path(folder)))


if __name__ == "__main__":
    main()
