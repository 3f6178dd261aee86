"""A channel that drifts is told by name and size; motion that both speeds show is not drift."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.tell.drift import drifts
from hil.core.channels import OUTPUTS
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_problem

Array = np.ndarray


def drifting(problem: Problem, sizes: tuple[float, float, float]) -> tuple[Problem, list[Array]]:
    """The recording with slow swings of `sizes` on its channels, and what it would be without."""
    trace = problem.traces[0]
    clean = trace.samples.copy()
    rng = np.random.default_rng(3)
    swing = np.sin(2 * np.pi * np.arange(len(clean)) * trace.dt / 30.0)
    seen = clean + np.outer(swing, sizes) + rng.normal(size=clean.shape) * np.array(NOISE)
    count = len(trace.measured)
    measured = seen[: count * trace.block].reshape(count, trace.block, 3).mean(axis=1)
    other = dataclasses.replace(trace, samples=seen, measured=measured)
    return dataclasses.replace(problem, traces=(other,)), [clean]


@pytest.mark.parametrize("column", [0, 1, 2])
def test_a_drift_is_told_by_channel_and_size(column: int) -> None:
    sizes = [0.0, 0.0, 0.0]
    sizes[column] = 4.0 * NOISE[column]
    problem, clean = drifting(one_problem(seconds=15.0), (sizes[0], sizes[1], sizes[2]))
    (told,) = drifts(problem, clean)
    assert told.startswith(f"{OUTPUTS[column]} drifts slowly beside all else: by ")
    assert float(told.split(" by ")[1].split()[0]) == pytest.approx(4.0 * NOISE[column], rel=0.15)
    assert " within the 15 s of one" in told


def test_noise_and_common_motion_are_no_drift() -> None:
    problem, clean = drifting(one_problem(seconds=15.0), (0.0, 0.0, 0.0))
    assert drifts(problem, clean) == []
    wheel = 8.0 * NOISE[1]
    problem, clean = drifting(one_problem(seconds=15.0), (problem.gear_ratio * wheel, wheel, 0.0))
    assert drifts(problem, clean) == []
