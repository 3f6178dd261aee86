"""How far order and phase of a ripple may be off because the angle that they count from wanders.

An angle integrated from a noisy speed is a random walk, and one that is counted by a ratio is as wrong as the
ratio. Tracking turns every recording's angle to where the ripple says; a fit with these angles takes them for
exact, and so its own standard errors of order and phase say next to nothing. What tells how far off both may
be is how far the recordings had to be turned, each by itself; and of an order, how far what is left of the
speed takes the angle: tracking does not follow what the ripple is too weak to show.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.thresholds import SOON_S, WALK_S, WINDOW_S
from hil.analysis.diagnosis.search.tracking import RIPPLES

Array = npt.NDArray[np.float64]


def with_wandering(problem: Problem, best: Fit) -> Fit:
    """The fit, its `scatter` grown by what the angles of its ripples say of order and phase."""
    scatter = np.zeros(len(best.theta)) if best.scatter is None else best.scatter.copy()
    measured = problem.following(best.hypothesis, best.theta).angles
    model = best.hypothesis.model(best.theta)
    given = len(best.hypothesis.base.effects)
    for term, use in enumerate(best.hypothesis.terms):
        if use.id not in RIPPLES:
            continue
        column, channel = RIPPLES[use.id]
        order = float(model.effects[given + term].values["order"])
        turns = [
            _Turn.of(before[:, column], after[:, column], order, t.dt)
            for before, after, t in zip(measured, best.angles, problem.traces, strict=True)
        ]
        walked = max(_order_error(turns), order * _walk_error(problem, best, channel))
        off = {"order": np.hypot(walked, order * _ratio_error(problem, best, channel))}
        off["phase_rad"] = _phase_error(turns, order)
        if len(turns) == 1:  # no other recording disagrees with it
            off["phase_rad"] = max(off["phase_rad"], order * _walk(problem, best, channel))
        for index, c in enumerate(best.hypothesis.coordinates()):
            if c.term == term and c.name in off:
                scatter[index] = np.hypot(scatter[index], off[c.name])
    return replace(best, scatter=scatter)


@dataclass(frozen=True)
class _Turn:
    """One recording: angle as measured and how far its phase was turned from it, rad, window by window."""

    angle: Array
    drift: Array
    window: float

    @classmethod
    def of(cls, measured: Array, turned: Array, order: float, dt: float) -> _Turn:
        """Angles at every sample, `dt` s apart."""
        length = max(1, round(WINDOW_S / dt))
        drift = order * (turned - measured)[::length]
        return cls(measured[::length], drift, length * dt)


def _order_error(turns: list[_Turn]) -> float:
    """Standard error of a slope through the turned phases over the angle, in all recordings.

    The larger of two: steps of the walk that know nothing of each other, and recordings that do not.
    """
    steps = [(np.diff(one.angle), np.diff(one.drift)) for one in turns]
    angles = sum(float(a @ a) for a, _ in steps)
    if angles <= 0.0:
        return 0.0
    alone = sum(float((a * d) @ (a * d)) for a, d in steps)
    together = sum(float(a @ d) ** 2 for a, d in steps) * _few(len(steps))
    return float(np.sqrt(max(alone, together)) / angles)


def _walk_error(problem: Problem, best: Fit, channel: int) -> float:
    """Relative standard error of angles, from what is left of the speed that they are integrated from."""
    angles = walks = 0.0
    for index in range(len(problem.traces)):
        speed, left, step = _speed(problem, best, index, channel)
        length = max(1, round(WALK_S / step))
        whole = len(left) // length * length
        walk, angle = (v[:whole].reshape(-1, length).sum(axis=1) * step for v in (left, speed))
        angles += float(angle @ angle)
        walks += float((angle * walk) @ (angle * walk))
    return float(np.sqrt(walks)) / angles if angles > 0.0 else 0.0


def _walk(problem: Problem, best: Fit, channel: int) -> float:
    """How far, in rad rms, what is left of its speed takes the angle of the first recording."""
    _, left, step = _speed(problem, best, 0, channel)
    return float(np.sqrt(np.mean(np.cumsum(left * step) ** 2)))


def _speed(problem: Problem, best: Fit, index: int, channel: int) -> tuple[Array, Array, float]:
    """Speed that an angle is integrated from and what is left of it, block means in rad/s of the angle; s.

    The other speed by the gear ratio where `channel` was not measured; nothing where neither counts.
    """
    trace = problem.traces[index]
    read = channel if trace.has[channel] else 1 - channel
    ratio, weight = problem.gear_ratio ** (read - channel), float(problem.weights[index][read])
    step = trace.dt * trace.block
    if weight <= 0.0:
        none = np.zeros(len(trace.measured))
        return none, none, step
    return ratio * trace.measured[:, read], ratio * best.errors[index].channels[:, read] / weight, step


def _phase_error(turns: list[_Turn], order: float) -> float:
    """Standard error of the phase that all recordings have in common, each weighed as tracking weighs it."""
    firsts, weights = [], []
    for one in turns:
        whole = np.abs(one.angle - one.angle[0]) * abs(order) > 2.0 * np.pi
        if whole.any():
            weights.append(1.0 / (SOON_S + float(np.argmax(whole)) * one.window))
            firsts.append((one.drift[0] + np.pi) % (2.0 * np.pi) - np.pi)
    if not firsts:
        return 0.0
    apart = np.array(weights) * np.array(firsts)
    return float(np.sqrt(apart @ apart * _few(len(firsts))) / np.sum(weights))


def _few(count: int) -> float:
    """What a variance over a few recordings is too small by, one number having been taken from them."""
    return count / max(count - 1, 1)


def _ratio_error(problem: Problem, best: Fit, channel: int) -> float:
    """Relative standard error of an angle that another speed and the gear ratio stand for."""
    if all(t.has[channel] or not t.has[1 - channel] for t in problem.traces):
        return 0.0
    return best.hypothesis.freedom("gear_ratio")[1]
