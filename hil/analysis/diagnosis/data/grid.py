"""Channels whose readings lie on a grid."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.thresholds import LEAST_LEVELS, ON_GRID

Array = npt.NDArray[np.float64]


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
