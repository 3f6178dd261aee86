"""Lets everything be compiled that a run and a served bench use, into the cache of the environment.

`python -m tests.can_vm.compiling FILE` writes the plan's figures in virtual time there.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

from hil.engine import RunRequest, run_plan
from tests.benches_for_tests import plan, sim_bench
from tests.can_vm.plans import BOTH_CONTROLLERS, CRITERIA
from tests.hil.engine.run.test_wall_clock import bench_in_real_time


def main() -> None:
    both = plan(BOTH_CONTROLLERS, CRITERIA)
    with tempfile.TemporaryDirectory() as folder:
        right = run_plan(RunRequest(both, sim_bench("right"), Path(folder, "virtual"))).result
        with bench_in_real_time("compiled") as (bench, _, _):
            run_plan(RunRequest(both, bench, Path(folder, "wall")))
    figures = {criterion.id: criterion.value for criterion in right.criteria}
    Path(sys.argv[1]).write_text(json.dumps(figures))


if __name__ == "__main__":
    main()
