"""What a hypothesis shows of each recording, from the initial values that suit it best."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._problem import MOTOR, STARTS, WHEEL, Problem

Array = npt.NDArray[np.float64]


def settled_starts(
    problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array]
) -> list[Array]:
    """Initial values of each recording at which the plant, held at `theta`, fits best.

    What begins at rest does so: a motion at the start would hide part of what a plant misses. Its shafts may
    hold a torque, and where a play begins in its gap wheel and vehicle may differ.
    """
    slots, sensors = hypothesis.packed(theta)
    found = []
    for index, start in enumerate(starts):
        steps = problem.start_steps()
        free = problem.free_starts(index, hypothesis)
        if problem.resting[index]:
            free = [c for c in free if c not in (MOTOR, WHEEL)]
            start = np.where(np.isin(range(STARTS), free), start, 0.0)
        for _ in range(3):
            tried = np.tile(start, (1 + STARTS, 1))
            tried[1:] += np.diag(steps)
            sets = len(tried)
            simulated = problem.outputs(
                index, np.tile(slots, (sets, 1)), np.tile(sensors, (sets, 1, 1)), tried
            )
            error = problem.errors(index, simulated[0]).ravel()
            change = problem.changes(index, simulated).reshape(STARTS, -1).T / steps
            if not (np.isfinite(change).all() and np.any(change)):
                break
            start = start.copy()
            start[free] += np.linalg.lstsq(change[:, free], error, rcond=1e-8)[0]
        found.append(start)
    return found


def simulated_samples(
    problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array]
) -> list[Array]:
    """Channels of each recording at full rate, n x 3."""
    slots, sensors = hypothesis.packed(theta)
    return [
        problem.simulated(index, slots[None], sensors[None], start[None], 1)[0]
        for index, start in enumerate(starts)
    ]
