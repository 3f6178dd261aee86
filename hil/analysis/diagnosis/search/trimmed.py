"""Numbers that most of the recordings agree with, where a few stretches hold most of the error.

Least squares bend every number for the stretches in which a play moves chaotically, or in which an effect
that is still missing matters most, and then hide both. Fitted to that half of the recordings which it
explains best, a model comes to what it says there (a concentration step of least trimmed squares: Rousseeuw
and Van Driessen, Data Min. Knowl. Discov. 12, 2006).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.trace import Flags
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import settled_starts
from hil.analysis.diagnosis.search.thresholds import TRIMMED_S, TRIMMED_SHARE

Array = npt.NDArray[np.float64]


def trimmed(problem: Problem, one: Fit) -> Fit:
    """`one` with the numbers that its better half of the recordings asks for; its errors are those of all."""
    problem = problem.with_angles(one.angles)
    there = fit(problem.judging(_best_explained(problem, one)), one.hypothesis, one.starts, one.theta)
    # how a recording begins is stated by how it begins, be it explained or not
    starts = settled_starts(problem, one.hypothesis, there.theta, one.starts)
    return fit(problem, one.hypothesis, starts, there.theta, rounds=0)


def window_means(power: Array, length: int) -> Array:
    """Mean of each window, the last one shorter."""
    starts = np.arange(0, len(power), length)
    return np.asarray(np.add.reduceat(power, starts) / np.diff([*starts, len(power)]))


def _best_explained(problem: Problem, one: Fit) -> list[Flags]:
    """Of each recording the blocks of those windows that together are the half with the least error."""
    length = max(1, round(TRIMMED_S / (problem.traces[0].dt * problem.traces[0].block)))
    powers = [window_means(np.sum(errors.channels**2, axis=1), length) for errors in one.errors]
    limit = np.quantile(np.concatenate(powers), TRIMMED_SHARE)
    return [
        np.repeat(power <= limit, length)[: len(errors.channels)]
        for power, errors in zip(powers, one.errors, strict=True)
    ]
