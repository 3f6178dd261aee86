"""A drag that keeps a model from drifting, where recordings do not excite what would name it.

Octaves below the lines of a torque that repeats itself decide no name. A model without any loss still drifts
there, by many times what it should show, and whoever simulates it sees that and nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import Point
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import may_join
from hil.analysis.missing_effects._search import HALF, is_loss
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]

_DRAGS = {"viscous_drag": "motor_inertia", "load_viscous_drag": "vehicle_inertia"}
_TIMES_S = np.geomspace(0.01, 100.0, 81)  # in which a drag would stop its inertia


def held_against_drift(problem: Problem, point: Point) -> EffectUse | None:
    """The drag with which a hypothesis without any loss leaves least; None where there is no need of one."""
    hypothesis = point.hypothesis
    uses = (*hypothesis.base.effects, *hypothesis.terms)
    if hypothesis.numbers.get("viscous_drag") or any(is_loss(use) for use in uses):
        return None
    if not any(one.lowest_hz > 0.0 for one in problem.series):
        return None
    tried = [
        EffectUse(id_, {"coefficient_nms_rad": float(hypothesis.numbers[inertia] / time_s)})
        for id_, inertia in _DRAGS.items()
        if inertia in hypothesis.numbers and may_join(EFFECTS[id_], hypothesis)
        for time_s in _TIMES_S
    ]
    left = _left(problem, point, [hypothesis, *(hypothesis.with_term(use) for use in tried)])
    best = int(np.argmin(left))
    return tried[best - 1] if left[best] < HALF * left[0] else None


def _left(problem: Problem, point: Point, hypotheses: Sequence[Hypothesis]) -> Array:
    """Squares of errors of each hypothesis over those of the signals, at all frequencies."""
    packed = [one.packed() for one in hypotheses]

    def of(index: int) -> Array:
        one = problem.series[index]
        starts = np.repeat(point.starts[index][None], len(packed), axis=0)
        shown = problem.simulated(index, packed, starts, keep=False)
        away = (one.measured - shown)[:, :, one.has] / np.sqrt(problem.signal[one.has])
        return np.asarray(np.sum(away**2, axis=(1, 2)))

    return np.asarray(sum(problem.each(of)))
