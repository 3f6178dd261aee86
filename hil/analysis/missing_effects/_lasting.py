"""Whether what was found lasts: an effect over a recording, and a model over all that it is simulated on.

An effect's number is let change in a straight line over each recording. Its change of the errors, beside
what all numbers and starts could do, takes α·d·r - ½ α²·d·d off the misfit (score test, C. R. Rao, Proc.
Cambridge Phil. Soc. 44 (1948) 50). Where that pays as one more number must, the effect is worth the share
that is always there: a gain that fades is no gain.

Octaves below the lines of a torque that repeats itself decide no name. A model without any loss still drifts
there, by many times what it should show, and whoever simulates it sees that and nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import Linearised, Point, without
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import may_join
from hil.analysis.missing_effects._search import HALF, is_loss
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]

_DRAGS = {"viscous_drag": "motor_inertia", "load_viscous_drag": "vehicle_inertia"}
_TIMES_S = np.geomspace(0.01, 100.0, 81)  # in which a drag would stop its inertia


def constancy(problem: Problem, at: Linearised, index: int, cost: float) -> float:
    """Least size of an effect in a recording as a share of what it is in the mean, 0 to 1.

    Of several numbers those count that do as much: air at a walking pace says nothing of rolling.

    Args:
        index: of the effect.
        cost: growth of log L that one more number must bring.
    """
    effect = EFFECTS[at.point.hypothesis.terms[index].id]
    sizes, does = np.zeros((2, len(at.coordinates)))
    for place, one in enumerate(at.coordinates):
        size = abs(one.at(0.0) - effect.off)
        if one.term == index and one.name in effect.acting() and size < math.inf:
            sizes[place] = size / abs(one.slope(0.0))
            does[place] = sizes[place] * np.linalg.norm(at.slopes[:, place])
    least = 1.0
    for place in np.flatnonzero(does > HALF * np.max(does, initial=0.0)).tolist():
        gain, moved = _change(problem, at, place)
        if gain > cost:
            least = min(least, 1.0 - 0.5 * abs(moved) / sizes[place])
    return float(max(least, 0.0))


def _change(problem: Problem, at: Linearised, place: int) -> tuple[float, float]:
    """Growth of log L if a coordinate changes over each recording, and its change from end to end."""
    one, hypothesis = at.coordinates[place], at.point.hypothesis
    moved = hypothesis.moved([one], np.array([one.step]))
    both = [hypothesis.packed(), moved.packed()]
    parts = []
    for index, start in enumerate(at.point.starts):
        shown = problem.simulated(index, both, np.stack([start, start]))
        ramp = np.linspace(-0.5, 0.5, shown.shape[1])[:, None]
        change = problem.weighed(index, ((shown[1] - shown[0]) / one.step * ramp)[None])[0]
        parts.append(without(at.bases[index], change))
    change = np.concatenate(parts)
    slopes, left = at.slopes[: len(change)], at.left[: len(change)]
    change = change - slopes @ (at.covariance @ (slopes.T @ change))
    square, right = float(change @ change), float(change @ left)
    if square <= 0.0:
        return 0.0, 0.0
    return _growth(0.5 * right**2 / square, 0.5 * float(at.left @ at.left)), right / square


def _growth(drop: float, whole: float) -> float:
    """Of log L where a drop of the weighed squares lets the discrepancy shrink along with them."""
    return -whole * math.log(max(1.0 - drop / max(whole, 1e-300), 1e-12))


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
