"""Other minima of an abrupt effect: a play's misfit has many, which slopes do not lead out of.

The effect's own numbers are drawn around where a fit ended (Sobol's sequence); every other number follows to
first order (variable projection, G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413), so that a draw
costs one simulation. The one that leaves least begins another fit.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy.stats import qmc

from hil.analysis.missing_effects._fit import Linearised
from hil.analysis.missing_effects._hypothesis import Coordinate, Hypothesis
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import at_its_best
from hil.core.effects import EFFECTS

Array = npt.NDArray[np.float64]

_DRAWS = 64
_AROUND = 0.25  # of the logarithm of numbers that an effect must have
_FAR = 1.4  # of the logarithm of optional ones, which are known less


def other_minimum(problem: Problem, at: Linearised, reach: float) -> tuple[float, Hypothesis]:
    """Growth of log L that another minimum of the abrupt effects promises, and where a fit of it begins.

    Args:
        reach: how far it is looked for, as a share of the usual way.
    """
    hypothesis = at.point.hypothesis
    mine = [one.term >= 0 and EFFECTS[hypothesis.terms[one.term].id].abrupt for one in at.coordinates]
    own = [one for one, is_own in zip(at.coordinates, mine, strict=True) if is_own]
    rest = at.holding(mine)
    drawn = [hypothesis.moved(own, _moves(own, hypothesis, reach * x)) for x in _draws(len(own))]
    return at_its_best(problem, rest, drawn)


def _moves(own: list[Coordinate], hypothesis: Hypothesis, draw: Array) -> Array:
    """Coordinates of numbers times e^(reach x), x from -1 to 1; one that is zero stays."""
    found = np.zeros(len(own))
    for index, (one, x) in enumerate(zip(own, draw.tolist(), strict=True)):
        parameters = EFFECTS[hypothesis.terms[one.term].id].parameters
        optional = next(p.optional for p in parameters if p.name == one.name)
        value = one.at(0.0) * float(np.exp((_FAR if optional else _AROUND) * x))
        found[index] = one.of(min(max(value, one.lower), one.upper))
    return found


@lru_cache
def _draws(numbers: int) -> Array:
    """In -1 to 1, (draws, numbers); the same ones every time."""
    return np.asarray(2.0 * qmc.Sobol(numbers, scramble=False).random(_DRAWS) - 1.0)
