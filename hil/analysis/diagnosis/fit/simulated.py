"""What a hypothesis shows of each recording, from the initial values that suit it best."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import MOTOR, STARTS, WHEEL, Problem
from hil.analysis.diagnosis.fit.thresholds import REST_SIGMAS

Array = npt.NDArray[np.float64]


def settled_starts(
    problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array]
) -> list[Array]:
    """Initial values of each recording at which the plant, held at `theta`, fits best.

    What begins at rest does so, but for what its first samples cannot tell from rest: a motion at the start
    would hide part of what a plant misses. Its shafts may hold a torque, and where a play begins in its gap
    wheel and vehicle may differ.
    """
    slots, sensors = hypothesis.packed(theta)
    found = []
    for index, start in enumerate(starts):
        steps = problem.start_steps()
        free = problem.free_starts(index, hypothesis)
        resting = problem.resting[index]
        if resting:
            free = [c for c in free if c not in (MOTOR, WHEEL)]
            start = np.where(np.isin(range(STARTS), free), start, 0.0)
            slowest, fastest = creeping(problem, index)
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
            if resting:
                bounds = (slowest - start[WHEEL], fastest - start[WHEEL])
                start = start + _crept(change, error, free, problem.gear_ratio, bounds)
            else:
                start = start + _moved(change, error, free)
        found.append(start)
    return found


def _moved(change: Array, error: Array, free: list[int]) -> Array:
    """By how much the `free` initial values are best moved: `change` is the derivative, rows x values."""
    moved = np.zeros(STARTS)
    moved[free] = np.linalg.lstsq(change[:, free], error, rcond=1e-8)[0]
    return moved


def _crept(change: Array, error: Array, free: list[int], ratio: float, bounds: tuple[float, float]) -> Array:
    """The same where all turns as one besides, the wheels by a speed within `bounds` (rad/s)."""
    together = np.zeros(STARTS)
    together[[MOTOR, WHEEL]] = ratio, 1.0
    creep = change @ together
    best = np.linalg.lstsq(np.column_stack([creep, change[:, free]]), error, rcond=1e-8)[0][0]
    by = np.clip(best, *bounds)
    return np.asarray(by * together + _moved(change, error - by * creep, free))


def creeping(problem: Problem, index: int) -> tuple[float, float]:
    """Slowest and fastest speed, rad/s of the wheel, that a recording's first samples cannot tell from rest.

    A channel that reads a speed there is off by an offset, where another one says that the axle rests.
    """
    trace = problem.traces[index]
    ratio = np.array([problem.gear_ratio, 1.0])
    read = trace.start[:2] / ratio
    unsure = REST_SIGMAS * problem.noise[:2] / np.sqrt(trace.start_samples) / ratio
    tells = np.abs(read) < unsure
    if not tells.any():
        return 0.0, 0.0
    return float(np.max((read - unsure)[tells])), float(np.min((read + unsure)[tells]))


def simulated_samples(
    problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array]
) -> list[Array]:
    """Channels of each recording at full rate, n x 3."""
    slots, sensors = hypothesis.packed(theta)
    return [
        problem.simulated(index, slots[None], sensors[None], start[None], 1)[0]
        for index, start in enumerate(starts)
    ]
