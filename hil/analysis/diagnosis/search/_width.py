"""How wide a play is, read from what most of a recording says.

Least squares look at the largest errors, and those of a play lie where its motion is chaotic, or hang on
where in the play the axle stood as the recording began: there every width is as wrong as any other. The sum
of the logarithms of errors looks at the many stretches in which a width is right or wrong, and leads to the
right one from far (a redescending M-estimator: Holland and Welsch, Commun. Statist. A6, 1977).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.search._thresholds import WIDTH_FINE, WIDTH_GRID, WINDOW_OF_ERRORS_S
from hil.core.effects import EFFECTS

Array = npt.NDArray[np.float64]


def width_of(hypothesis: Hypothesis) -> int | None:
    """Which coordinate is the width of a play that the newest effect remembers a place in, if it does."""
    effect = EFFECTS[hypothesis.ids[-1]]
    rough = {p.name for p in effect.parameters if p.rough}
    newest = len(hypothesis.terms) - 1
    found = [i for i, c in enumerate(hypothesis.coordinates()) if c.term == newest and c.name in rough]
    return found[0] if found and effect.law.begin is not None else None


def with_likely_width(
    problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array], index: int
) -> Array:
    """`theta` with its number `index`, a width, where most of the recordings agree with it."""
    c = hypothesis.coordinates()[index]

    def at(width: float) -> Array:
        other = theta.copy()
        other[index] = np.clip(width, c.lower, c.upper)
        return other

    def cost(width: float) -> float:
        return float(np.mean(np.log1p(window_errors(problem, hypothesis, at(width), starts) ** 2)))

    grid = theta[index] + np.log(WIDTH_GRID)
    costs = [cost(width) for width in grid]
    best = int(np.argmin(costs))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    finer = minimize_scalar(cost, bounds=(low, high), method="bounded", options={"xatol": WIDTH_FINE})
    return at(float(finer.x) if finer.fun < costs[best] else float(grid[best]))


def window_errors(problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array]) -> Array:
    """Rms error of each short window of all recordings over its measured channels, noise levels.

    The median of a speed's error is taken out: an initial speed that is off stays off, and says nothing.
    """
    slots, sensors = hypothesis.packed(theta)
    found = []
    for index, (trace, start) in enumerate(zip(problem.traces, starts, strict=True)):
        error = problem.errors(index, problem.outputs(index, slots[None], sensors[None], start[None])[0])
        error = error[trace.judged_blocks][:, trace.has]
        speeds = np.flatnonzero(trace.has) < 2
        error = error - np.where(speeds, np.median(error, axis=0), 0.0)
        length = max(1, min(round(WINDOW_OF_ERRORS_S / (trace.dt * trace.block)), len(error)))
        count = len(error) // length
        parts = error[: count * length].reshape(count, length, -1)
        found.append(np.sqrt(np.mean(parts**2, axis=(1, 2))))
    return np.concatenate(found)
