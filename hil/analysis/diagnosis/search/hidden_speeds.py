"""Speeds at the start of recordings that have no speed channel.

Without friction they make no difference to a shaft's torque: a fit leaves them at zero. With friction
everything hangs on them, and from rest no small change tells a descent that the axle was turning.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import MOTOR, WHEEL, Problem
from hil.analysis.diagnosis.search.thresholds import HIDDEN_SPEEDS_RAD_S

Array = npt.NDArray[np.float64]


def with_hidden_speeds(
    problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array]
) -> list[Array]:
    """`starts`, recordings without a speed channel from the speed that suits them best at `theta`."""
    return [
        start if problem.traces[index].has[:2].any() else _suited(problem, hypothesis, theta, index, start)
        for index, start in enumerate(starts)
    ]


def _suited(problem: Problem, hypothesis: Hypothesis, theta: Array, index: int, start: Array) -> Array:
    speeds = np.array([*(-s for s in reversed(HIDDEN_SPEEDS_RAD_S)), *HIDDEN_SPEEDS_RAD_S])
    tried = np.tile(start, (1 + len(speeds), 1))
    tried[1:, MOTOR] = speeds
    tried[1:, WHEEL] = speeds / problem.gear_ratio
    return problem.cheapest_start(index, hypothesis.packed(theta), tried)[0]
