"""Angles as a ripple itself tells them, where noise lets those that are integrated walk off.

A speed's noise makes its integral a random walk of known size, which a high order turns into whole turns
of phase. The walk joins the fit: its values at knots are linear to first order, with its own density as
their prior, so that a ripple that shows little moves no angle (it stands in place of the tracking of H. Vold,
J. Leuridan, SAE 931288 (1993), which follows an amplitude). Order and phase move along: a walk looks like
both of them, so that they would stay where they were when angles had walked off. An angle that a ripple tells
to no better than `_KNOWN_RAD` of its phase says nothing of it: a sine is not straight so far.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import Point, without
from hil.analysis.missing_effects._hypothesis import Hypothesis, tolerance_of
from hil.analysis.missing_effects._orders import Side, turned_with
from hil.analysis.missing_effects._problem import Problem
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from hil.plant import begins_of, gear_ratio_of, simulate_many

Array = npt.NDArray[np.float64]

_KNOTS_S = 1.0  # apart
_ASIDE_RAD = 0.1  # of phase, by which a knot is moved to see what that does
_ROUNDS = 6
_STEPS = (1.0, 0.5, 0.25)
_NO_WALK = 1e-3  # of a speed's noise: an angle is read anew at every sample
_SETTLED = 1.0  # half the squares by which a round must fall
_KNOWN_RAD = 0.5  # of phase
_COLUMNS: dict[Side, int] = {"wheel": 0, "rotor": 1}


def tracked(problem: Problem, point: Point) -> tuple[Problem, Hypothesis]:
    """The same, angles by the speeds of a point and, where it has ripples, by what these say of them.

    The point's hypothesis comes along, order and phase of its ripples as they go with these angles.
    """
    turned, hypothesis = turned_with(problem, point), point.hypothesis
    ripples = [index for index, use in enumerate(hypothesis.terms) if EFFECTS[use.id].law.follows]
    if not ripples:
        return turned, hypothesis
    ratio = gear_ratio_of(problem.model) or 1.0
    by_noise = turned.weighed_by_noise()  # a walk is noise, not discrepancy
    walks = _walks(by_noise, point)
    read = problem.each(lambda index: problem.series[index].angles(ratio))
    angles = problem.each(lambda index: walks[index].likelier(turned.angles[index], read[index]))
    for index in ripples:
        if hypothesis is not point.hypothesis:  # the ripple before has moved
            walks = _walks(by_noise, replace(point, hypothesis=hypothesis))
        followed = _Followed(by_noise, walks, hypothesis.terms[index], angles)
        angles = followed.walked()
        hypothesis = hypothesis.with_values(index, followed.order_and_phase(), hypothesis.opened[index])
    return replace(turned, angles=tuple(angles)), hypothesis


def _walks(problem: Problem, point: Point) -> list[_Walk]:
    return problem.each(lambda index: _Walk(problem, point, index))


def errors_of(problem: Problem, point: Point, use: EffectUse) -> dict[str, float]:
    """Standard errors of a ripple's order and phase where angles may have walked off.

    An order of a side whose speed was not recorded is known as far as the gear ratio.
    """
    by_noise = problem.weighed_by_noise()
    followed = _Followed(by_noise, _walks(by_noise, point), use, problem.angles)
    ramp, offset = np.sqrt(np.diag(followed.step(problem.each(followed.linearised))[2]))
    order, column = float(use.values["order"]), 1 - followed.column  # of a speed
    if not all(one.has[column] for one in problem.series):
        ramp = np.hypot(ramp, tolerance_of(problem.model, "gear_ratio"))
    return {"order": order * float(ramp), "phase_rad": order * float(offset)}


class _Walk:
    """Errors of one recording, by its angles, beside a point of a fit."""

    def __init__(self, problem: Problem, point: Point, index: int) -> None:
        self.problem, self.point, self.index = problem, point, index
        self.one = problem.series[index]
        slots, sensor = point.hypothesis.packed()
        self.packed = slots[None], problem.sensors(index, [sensor])
        self.basis = problem.start_basis(index, point.hypothesis, point.starts[index])[1]

    def likelier(self, first: Array, other: Array) -> Array:
        """The first angles, n x 2, unless others are likelier."""
        is_other = _half_square(self.left(other)) < _half_square(self.left(first)) - _SETTLED
        return other if is_other else first

    def left(self, angles: Array) -> Array:
        """Weighed errors with such angles, without what starts could do."""
        one, (slots, sensors) = self.one, self.packed
        begins = begins_of(slots, self.point.starts[self.index][None])
        shown = simulate_many(slots, one.torque, one.dt, begins, sensors, one.block, angles, one.load)
        return without(self.basis, self.problem.weighed(self.index, one.measured - shown)[0])

    def variance_a_second(self, side: Side) -> float:
        """Of the walk of an integrated speed with noise, rad²/s; next to none of an angle.

        A side's angle is that of its own speed, where it was recorded.
        """
        own = 1 - _COLUMNS[side]
        ratio = gear_ratio_of(self.point.hypothesis.model()) or 1.0
        noise = np.sqrt(self.problem.slowest_noise(self.point.errors)[:2])
        noise[self.one.of_angle[:2]] *= _NO_WALK
        if not np.isfinite(self.one.samples[0, own]):
            own, noise = 1 - own, noise * [1.0 / ratio, ratio]
        return float(noise[own] ** 2 * self.one.block * self.one.dt)


_Linear = tuple[Array, Array]


class _Followed:
    """Walks of all recordings' angles at knots, and what they share: ramp and offset, by order and phase."""

    def __init__(
        self, problem: Problem, walks: Sequence[_Walk], use: EffectUse, begun: Sequence[Array]
    ) -> None:
        side = EFFECTS[use.id].law.follows
        assert side is not None
        self.problem, self.walks, self.begun, self.column = problem, walks, begun, _COLUMNS[side]
        self.order, self.phase_rad = float(use.values["order"]), float(use.values["phase_rad"])
        self.aside = _ASIDE_RAD / self.order
        self.hats, self.along, self.priors = [], [], []
        for walk, angles in zip(walks, begun, strict=True):
            count, dt = len(angles), walk.one.dt
            knots = max(2, round(count * dt / _KNOTS_S) + 1)
            turned = np.interp(np.linspace(0.0, count - 1.0, knots), np.arange(count), angles[:, self.column])
            rate = walk.variance_a_second(side) * count * dt / (knots - 1)
            self.hats.append(_hats(count, knots))
            self.along.append(np.stack([turned, np.ones(knots)]))
            self.priors.append(np.linalg.inv(rate * _strayed(knots)))
        self.knots = [np.zeros(len(one)) for one in self.hats]
        self.shared = np.zeros(2)
        self.left = problem.each(lambda index: walks[index].left(begun[index]))

    def angles(self, index: int, knots: Array, shared: Array) -> Array:
        """Of a recording that walk so, with what order and phase do."""
        moved = self.begun[index].copy()
        at = knots + shared @ self.along[index]
        moved[:, self.column] += at @ self.hats[index]
        return moved

    def walked(self) -> list[Array]:
        """The likeliest angles, n x 2 each, without what order and phase do."""
        each = range(len(self.walks))
        for _ in range(_ROUNDS):
            linear = self.problem.each(self.linearised)
            knots, shared, _ = self.step(linear)
            had = sum(map(_half_square, self.left)) + self._prior(self.knots)
            for part in _STEPS:
                there = [self.knots[index] + part * knots[index] for index in each]
                by = self.shared + part * shared
                stays = self.problem.each(lambda i: self.walks[i].left(self.angles(i, there[i], by)))  # noqa: B023
                has = sum(map(_half_square, stays)) + self._prior(there)
                if has < had - _SETTLED:
                    self.knots, self.shared, self.left = there, by, stays
                    break
            else:
                break
        return [self.angles(index, self.knots[index], np.zeros(2)) for index in each]

    def order_and_phase(self) -> dict[str, float]:
        """As they go with the angles that walked."""
        ramp, offset = self.shared.tolist()
        phase = self.phase_rad + self.order * offset
        return {"order": self.order * (1.0 + ramp), "phase_rad": math.remainder(phase, 2.0 * math.pi)}

    def linearised(self, index: int) -> _Linear:
        """Errors of a recording, and their slopes by its knots (knots x errors)."""
        walk, angles = self.walks[index], self.angles(index, self.knots[index], self.shared)
        left, changes = self.left[index], []
        for hat in self.hats[index]:
            moved = angles.copy()
            moved[:, self.column] += self.aside * hat
            changes.append((walk.left(moved) - left) / self.aside)
        return left, np.array(changes)

    def step(self, linear: Sequence[_Linear]) -> tuple[list[Array], Array, Array]:
        """Changes of all knots, of what is shared, and the covariance of the latter, walks being unknown."""
        normal, gradient, parts = np.zeros((2, 2)), np.zeros(2), []
        for (left, slopes), along, prior, knots in zip(
            linear, self.along, self.priors, self.knots, strict=True
        ):
            doubt = np.diag(np.linalg.inv(slopes @ slopes.T + prior))
            slopes = slopes * (np.sqrt(doubt) * self.order < _KNOWN_RAD)[:, None]
            shared = along @ slopes
            inverse = np.linalg.inv(slopes @ slopes.T + prior)
            right, both = slopes @ left + prior @ knots, slopes @ shared.T
            normal += shared @ shared.T - both.T @ inverse @ both
            gradient += shared @ left - both.T @ inverse @ right
            parts.append((inverse, right, both))
        covariance = np.asarray(np.linalg.pinv(normal, hermitian=True), dtype=float)
        moved = -covariance @ gradient
        return [-inverse @ (right + both @ moved) for inverse, right, both in parts], moved, covariance

    def _prior(self, knots: Sequence[Array]) -> float:
        return sum(0.5 * float(one @ prior @ one) for one, prior in zip(knots, self.priors, strict=True))


def _strayed(knots: int) -> Array:
    """Covariance at knots of a random walk that is known where it begins, of one from a knot to the next.

    What shows an angle only somewhere between two knots tells these less: there a walk strays from the
    straight line by a sixth in the mean (the variance of a Brownian bridge).
    """
    each = np.arange(knots, dtype=float)
    return np.asarray(np.minimum(each[:, None], each) + np.eye(knots) / 6.0)


def _hats(count: int, knots: int) -> Array:
    """Straight from one at its own knot to zero at the next ones: knots x samples."""
    places = np.linspace(0.0, knots - 1.0, count)
    return np.maximum(1.0 - np.abs(places - np.arange(knots)[:, None]), 0.0)


def _half_square(values: Array) -> float:
    return 0.5 * float(values @ values)
