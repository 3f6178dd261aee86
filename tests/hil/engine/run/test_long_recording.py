"""A recording that is too long to be held: what judges, reports and identifies it says the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.frequency_response import experiments_of
from hil.core.channels import WHEEL_ANGLE
from hil.core.recording import Recording, driven_by_torque, read_recording
from hil.core.recording._stored import StoredColumns
from hil.engine import RunOutcome, RunRequest, run_plan
from reports import write_figures
from test_plans import load_plan, rejudged
from tests.benches_for_tests import sim_bench

FEW_BYTES = 1 << 16


def ran(plan: str, out: Path) -> tuple[RunOutcome, Recording, Recording]:
    """A run that held none of its rows at its end; its recording held, and left in its file."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hil.engine.run.recorder.MOST_KEPT_BYTES", FEW_BYTES)
        patch.setattr("hil.core.recording._stored.MOST_HELD_BYTES", FEW_BYTES)
        outcome = run_plan(RunRequest(load_plan(plan), sim_bench(plan), out))
        stored = read_recording(outcome.recording)
    assert outcome.error is None
    assert isinstance(stored.channels, StoredColumns)
    return outcome, read_recording(outcome.recording), stored


@pytest.mark.slow
def test_acceptance_is_judged_and_drawn_the_same(tmp_path: Path) -> None:
    outcome, held, stored = ran("acceptance", tmp_path / "run")
    assert sum(criterion.value is not None for criterion in outcome.result.criteria) > 10
    assert rejudged(held) == rejudged(stored)
    assert rejudged(held) == outcome.result
    drawn = [
        write_figures(one, outcome.result, tmp_path / name) for one, name in ((held, "a"), (stored, "b"))
    ]
    assert drawn[0].keys() == drawn[1].keys()
    assert all(drawn[0][figure].read_bytes() == drawn[1][figure].read_bytes() for figure in drawn[0])


@pytest.mark.slow
def test_an_identification_run_gives_the_same_experiments(tmp_path: Path) -> None:
    outcome, held, stored = ran("short_identification", tmp_path / "run")
    assert rejudged(held) == rejudged(stored)
    assert rejudged(held) == outcome.result
    for one, other in zip(experiments_of(held), experiments_of(stored), strict=True):
        assert np.array_equal(one.input, other.input)
        assert np.array_equal(one.outputs, other.outputs)
    for part, same in zip(driven_by_torque(held), driven_by_torque(stored), strict=True):
        assert part.source == same.source
        assert np.array_equal(part[WHEEL_ANGLE], same[WHEEL_ANGLE])
        assert np.array_equal(part["motor_speed_rad_s"], same["motor_speed_rad_s"])
