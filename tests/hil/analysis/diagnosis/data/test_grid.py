"""Readings that lie on a grid, and what their rounding does to noise."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.grid import coarse_noise, grid_step, grids
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_trace


@pytest.mark.parametrize("step", [0.01, 0.25, 3.0])
def test_the_step_of_a_grid_is_found(step: float) -> None:
    values = np.random.default_rng(1).normal(0.0, 10.0 * step, 4000)
    assert grid_step(np.round(values / step) * step) == pytest.approx(step, rel=1e-6)
    assert grid_step(values) == 0.0


def test_a_constant_lies_on_no_grid() -> None:
    assert grid_step(np.full(1000, 2.0)) == 0.0


def test_only_a_grid_that_matters_is_told() -> None:
    trace = one_trace()
    for step, told in ((2.0 * NOISE[0], 1), (0.02 * NOISE[0], 0)):
        samples = trace.samples.copy()
        samples[:, 0] = np.round(samples[:, 0] / step) * step
        found = grids([dataclasses.replace(trace, samples=samples)], np.array(NOISE))
        assert [use.values["channel"] for use in found] == [OUTPUTS[0]] * told


def test_rounding_coarser_than_the_noise_does_not_average_out() -> None:
    fine, coarse = (
        EffectUse("sensor_quantization", {"channel": OUTPUTS[1], "step": step}) for step in (0.5, 4.0)
    )
    noise = np.ones(3)
    assert coarse_noise(noise, [fine]) == pytest.approx(noise)
    weighed = coarse_noise(noise, [coarse])
    assert weighed == pytest.approx([1.0, 2.0 * 4.0 / np.sqrt(12.0), 1.0])
