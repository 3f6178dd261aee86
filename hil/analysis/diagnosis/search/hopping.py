"""A play fitted past its false minima.

Each time that flanks meet is a corner of the cost, so that its valley is full of small hollows: a descent
ends in the next one, far from the bottom by its own standard errors. From where it is, moved a little at
random, it often ends lower (basin hopping: Wales and Doye, J. Phys. Chem. A 101, 1997); and how far apart
hollows lie that are nearly as deep is how well the numbers are known. Each hop slides down by the derivatives
of the lowest fit, and is fitted where it comes below it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.allowance import Allowance, OutOfTimeError
from hil.analysis.diagnosis.fit.far import Slid, slid
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.optional import little
from hil.analysis.diagnosis.search.thresholds import HOLLOWS, HOP_SIZES, HOPPING_S, HOPS, HOPS_IN_VAIN

Array = npt.NDArray[np.float64]


def hopped(problem: Problem, best: Fit) -> Fit:
    """The lowest of fits from near `best`, with its scatter and that of those that are nearly as low.

    `best` itself where none of its effects remembers a place. The same problem gives the same hops, as many
    as there is time for.
    """
    if not best.hypothesis.remembers_place:
        return best
    problem = replace(problem.with_angles(best.angles), allowance=Allowance(HOPPING_S))
    rng = np.random.default_rng(0)
    moved = np.array([c.scale == "log" for c in best.hypothesis.coordinates()])
    starts = problem.first_starts()
    lowest, found, vain = best, [(best.total, best.theta)], 0
    for number in range(HOPS):
        size = np.exp(rng.uniform(*np.log(HOP_SIZES)))
        theta = lowest.theta + size * rng.normal(size=len(moved)) * moved
        try:  # the place in the play at the beginning is one of the corners
            one: Slid | Fit = slid(problem, lowest, theta, lowest.starts if number % 2 else starts)
            if one.total < lowest.total:
                one = fit(problem, best.hypothesis, one.starts, one.theta, enough=little(problem, lowest))
        except OutOfTimeError:
            break
        found.append((one.total, one.theta))
        vain = 0 if one.total < lowest.total - little(problem, lowest) else vain + 1
        if isinstance(one, Fit):
            lowest = min(lowest, one, key=lambda each: each.total)
        if vain == HOPS_IN_VAIN:
            break
    near = [theta - lowest.theta for total, theta in found if total < HOLLOWS * lowest.total]
    apart = np.sqrt(np.mean(np.square(near), axis=0))
    scatter = apart if best.scatter is None else np.hypot(best.scatter, apart)
    return replace(lowest, scatter=scatter)
