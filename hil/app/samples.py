"""Recordings to try a diagnosis on: the simulated axle, with something in it that its model does not know."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from hil.core.channels import TIME
from hil.core.model import load_model
from hil.core.recording import Recording, driven_by_torque, read_recording, write_recording
from hil.engine import DEFAULT_BENCH, RunRequest, load_bench, run_plan
from hil.engine.commissioning.sim_bench import with_hidden
from test_plans import load_plan

#: What the axle has and its model has not, as `hil bench sim --hide` takes it.
HIDDEN = {"backlash": "0.01"}
MODEL = "axle.toml"


def sample_files(plan: Path, show: Callable[[float, str], None]) -> dict[str, bytes]:
    """A recording for each segment of the plan, and the model that knows nothing of it, by file name.

    Raises:
        HilError: the run failed.
    """
    bench = load_bench(DEFAULT_BENCH)
    assert bench.simulation is not None
    model = load_model(bench.simulation.model)
    with tempfile.TemporaryDirectory() as directory:
        out = Path(directory)
        outcome = run_plan(
            RunRequest(load_plan(plan), bench, out, model=with_hidden(model, HIDDEN), progress=show)
        )
        if outcome.error is not None:
            raise outcome.error
        files = {MODEL: bench.simulation.model.read_bytes()}
        for part in driven_by_torque(read_recording(outcome.recording)):
            path = out / f"{part.source.stem.split()[-1]}.csv"
            write_recording(_as_if_alone(part), path)
            files[path.name] = path.read_bytes()
    return files


def _as_if_alone(part: Recording) -> Recording:
    """A stretch of a run as another tool would have recorded it: channels from zero on, and nothing else."""
    began = part.time_s[0]
    return Recording({**part.channels, TIME: np.round(part.time_s - began, 6)}, part.source)
