"""Whether an effect stays what it is: a gain that fades over a recording is no gain.

The number of an effect is let change in a straight line over each recording. Its change of the errors, beside
what all numbers and starts could do, takes α·d·r - ½ α²·d·d off the misfit (score test, C. R. Rao, Proc.
Cambridge Phil. Soc. 44 (1948) 50). Where that pays as one more number must, the effect is worth the share
that is always there.
"""

from __future__ import annotations

import math

import numpy as np

from hil.analysis.missing_effects._fit import Linearised, growth, without
from hil.analysis.missing_effects._problem import Problem
from hil.core.effects import EFFECTS


def constancy(problem: Problem, at: Linearised, index: int, cost: float) -> float:
    """Least size of an effect in a recording as a share of what it is in the mean, 0 to 1.

    Args:
        index: of the effect.
        cost: growth of log L that one more number must bring.
    """
    effect = EFFECTS[at.point.hypothesis.terms[index].id]
    least = 1.0
    for place, one in enumerate(at.coordinates):
        size = abs(one.at(0.0) - effect.off)
        if one.term != index or one.name not in effect.acting() or not 0.0 < size < math.inf:
            continue
        gain, moved = _change(problem, at, place)
        if gain > cost:
            least = min(least, 1.0 - 0.5 * abs(moved * one.slope(0.0)) / size)
    return max(least, 0.0)


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
    return growth(0.5 * right**2 / square, 0.5 * float(at.left @ at.left)), right / square
