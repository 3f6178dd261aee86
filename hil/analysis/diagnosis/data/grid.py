"""Channels whose readings lie on a grid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import (
    COARSE_GRID,
    LEAST_GRID,
    LEAST_LEVELS,
    ON_GRID,
    ROUNDING_ALIKE,
)
from hil.analysis.diagnosis.data.trace import Trace
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


def grids(traces: Sequence[Trace], noise: Array) -> list[EffectUse]:
    """A `sensor_quantization` for each channel with a grid coarse enough to matter."""
    found = []
    for column, channel in enumerate(OUTPUTS):
        values = [t.samples[:, column] for t in traces if t.has[column] and not t.notes]
        if not values:
            continue
        step = grid_step(np.concatenate(values))
        if step > LEAST_GRID * float(noise[column]):
            found.append(EffectUse("sensor_quantization", {"channel": channel, "step": step}))
    return found


def coarse_noise(noise: Array, rounded: list[EffectUse]) -> Array:
    """Noise levels to weigh by: rounding errors of neighbouring samples are alike and do not average out."""
    levels = noise.copy()
    for use in rounded:
        column = OUTPUTS.index(str(use.values["channel"]))
        step = float(use.values["step"])
        if step > COARSE_GRID * levels[column]:
            levels[column] = max(levels[column], ROUNDING_ALIKE * step / np.sqrt(12.0))
    return levels


def grid_step(values: Array) -> float:
    """Distance of the grid that `values` lie on, in their unit; 0.0 if on none."""
    levels = np.unique(values)
    if len(levels) < LEAST_LEVELS:
        return 0.0
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-7 * max(float(np.ptp(values)), 1e-12)]
    if not gaps.size:
        return 0.0
    step = float(np.quantile(gaps, 0.02))
    for _ in range(3):
        counts = np.round(gaps / step)
        near = (counts > 0) & (counts < 50)
        if not near.any():
            return 0.0
        step = float(np.sum(gaps[near]) / np.sum(counts[near]))
    on_grid = abs(np.mean(np.exp(2j * np.pi * values / step)))
    # as many levels as a grid has room for, not as a continuum of readings would give
    dense = len(values) > 3 * len(levels)
    return step if on_grid > ON_GRID and dense else 0.0
