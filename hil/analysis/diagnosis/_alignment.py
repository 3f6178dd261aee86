"""Angles that ripples follow, corrected by the ripples themselves.

An angle integrated from a noisy speed drifts off like a random walk, by a good part of a turn of a high order
in half a minute. The drift is estimated with the ripple, on the first terms of the Karhunen-Loève expansion
of Brownian motion, each as likely as the speed's noise makes it: a phase-locked loop in hindsight.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis._coordinates import Hypothesis, sensors_of
from hil.analysis.diagnosis._fit import Fit, fit
from hil.analysis.diagnosis._problem import Problem
from hil.core.model import Model
from sim_backend.plant import pack, simulate_many

Array = npt.NDArray[np.float64]

#: Ripples, and the column of the angles (wheel, rotor) and of the channels that each follows.
RIPPLES = {"wheel_order_disturbance": (0, 1), "motor_order_ripple": (1, 0)}
_TERMS = (6, 40)  # at least, and at most
_BENT = 0.1  # rad of ripple phase that the terms left out may amount to
_SLOW_NOISE = 4.0  # power of a speed's noise at low frequency over that above all modes, at most
_TURN = 0.02  # rad of ripple phase: a finite difference
_LARGEST = 0.7  # rad of ripple phase: the most that one correction may be
_ROUNDS = 3
_AGAIN = 4


def has_ripple(hypothesis: Hypothesis) -> bool:
    """Whether a hypothesis knows a torque that follows an angle."""
    return any(term.id in RIPPLES for term in hypothesis.terms)


def aligned(problem: Problem, one: Fit) -> Fit:
    """The fit again after the angles of `problem` were corrected by what its ripples show."""
    if not has_ripple(one.hypothesis):
        return one
    for _ in range(_AGAIN):
        before = list(problem.angles)
        align(problem, one.hypothesis, one.theta, one.starts)
        again = fit(problem, one.hypothesis, one.starts, one.theta)
        if again.total > one.total:
            problem.angles = before
            return one
        small = one.total - again.total < 0.02 * (one.total - problem.rows)
        one = again
        if small:
            break
    return one


def align(problem: Problem, hypothesis: Hypothesis, theta: Array, starts: list[Array]) -> None:
    """Correct the angles of every recording for the ripples of a hypothesis, in place."""
    model = hypothesis.model(theta)
    for index, start in enumerate(starts):
        for _ in range(_ROUNDS):
            if not _corrected(problem, model, index, start):
                break


def _corrected(problem: Problem, model: Model, index: int, start: Array) -> bool:
    """One Gauss-Newton step of the drift's coefficients; False once it is small."""
    angles = problem.angles[index]
    trace = problem.traces[index]
    shapes, deviations = _drift(problem, model, index)
    slots, sensors = pack(model), sensors_of(model)

    def outputs(turned: Array, starts: Array) -> Array:
        size = len(starts)
        sets, reads = np.tile(slots, (size, 1)), np.tile(sensors, (size, 1, 1))
        return np.asarray(simulate_many(sets, trace.torque, trace.dt, starts, reads, trace.block, turned))

    steps = problem.start_steps()
    around = outputs(angles, np.vstack([start, start + np.diag(steps)]))
    error = problem.errors(index, around[0]).ravel()
    weights = problem.weights[index]
    columns = [((a - around[0]) * weights).ravel() / s for a, s in zip(around[1:], steps, strict=True)]
    sizes = [_TURN / max(float(np.max(np.abs(s))), 1e-12) for s in shapes]
    for shape, size in zip(shapes, sizes, strict=True):
        moved = outputs(angles + size * shape, start[None])[0]
        columns.append(((moved - around[0]) * weights).ravel() / size)
    jacobian = np.stack(columns, axis=1)
    precision = np.concatenate([np.full(len(steps), 1e-12), 1.0 / deviations**2])
    amounts = np.linalg.solve(jacobian.T @ jacobian + np.diag(precision), jacobian.T @ error)[len(steps) :]
    change = np.tensordot(amounts, np.stack(shapes), axes=1)
    largest = float(np.max(np.abs(change * _orders(model))))
    problem.angles[index] = angles + change * min(1.0, _LARGEST / max(largest, 1e-12))
    return largest > _TURN


def _orders(model: Model) -> Array:
    """Highest order of the wheel's and of the rotor's ripples, 0 where there is none."""
    orders = np.zeros(2)
    for use in model.effects:
        if use.id in RIPPLES:
            column = RIPPLES[use.id][0]
            orders[column] = max(orders[column], float(use.values["order"]))
    return orders


def _drift(problem: Problem, model: Model, index: int) -> tuple[list[Array], Array]:
    """Shapes (n x 2) of the angles' random walk, and the standard deviation of each in rad."""
    trace = problem.traces[index]
    samples = len(trace.torque)
    share = np.arange(samples) / samples
    shapes, deviations = [], []
    orders = _orders(model)
    for column, channel in RIPPLES.values():
        if orders[column] == 0.0:
            continue
        noise = float(problem.floor[channel])
        walk = noise * trace.dt * np.sqrt(samples * _SLOW_NOISE)
        for term in range(int(np.clip((orders[column] * walk / (np.pi * _BENT)) ** 2, *_TERMS))):
            bend = (term + 0.5) * np.pi
            shape = np.zeros((samples, 2))
            shape[:, column] = np.sqrt(2.0) * np.sin(bend * share)
            shapes.append(shape)
            deviations.append(walk / bend)
    return shapes, np.array(deviations)
