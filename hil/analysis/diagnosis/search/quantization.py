"""What the rounding of readings leaves in errors, and must not be taken for physics."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.coherence import split
from hil.analysis.diagnosis.data.trace import blocks
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import simulated_samples
from hil.analysis.diagnosis.search.thresholds import ROUNDING_MARGIN
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


def rounding_of(problem: Problem, rounded: list[EffectUse], base: Fit) -> Array:
    """What rounding alone would seem to be of physics in each channel, shape (3,), in noise variances.

    The channels that `base` simulates are rounded, and that error is split as the real one is. At most it is
    step² / 12: a slow signal keeps its rounding error over a whole block.
    """
    power = np.zeros(3)
    if not rounded:
        return power
    columns = [OUTPUTS.index(str(use.values["channel"])) for use in rounded]
    steps = [float(use.values["step"]) for use in rounded]
    simulated = simulated_samples(problem, base.hypothesis, base.theta, base.starts)
    errors = []
    for index, trace in enumerate(problem.traces):
        error = np.zeros_like(trace.measured)
        for column, step in zip(columns, steps, strict=True):
            clean = simulated[index][:, column]
            apart = blocks((np.round(clean / step) * step - clean)[:, None], trace.block)[:, 0]
            error[:, column] = apart * problem.weights[index][column]
        errors.append(error)
    seen = split(problem.traces, problem.weights, errors).physics
    for column, step in zip(columns, steps, strict=True):
        weight = max(float(w[column]) for w in problem.weights)
        power[column] = min(ROUNDING_MARGIN * float(seen[column]), (step * weight) ** 2 / 12.0)
    return power
