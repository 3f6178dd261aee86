"""Angles as a ripple itself tells them, where noise lets those that are integrated walk off.

A speed's white noise makes its integral a random walk of known size, which a high order turns into whole
turns of phase. The walk joins the fit: its values at knots are linear to first order, with the walk's own
density as their prior, so that a ripple that shows little moves no angle (it stands in place of the tracking
of H. Vold, J. Leuridan, SAE 931288 (1993), which follows an amplitude).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import Point, without
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
_COLUMNS: dict[Side, int] = {"wheel": 0, "rotor": 1}


def tracked(problem: Problem, point: Point) -> Problem:
    """The same, angles by the speeds of a point and, where it has ripples, by what these say of them."""
    turned = turned_with(problem, point)
    uses = [use for use in point.hypothesis.terms if EFFECTS[use.id].law.follows]
    if not uses:
        return turned
    ratio = gear_ratio_of(problem.model) or 1.0
    by_noise = turned.weighed_by_noise()  # a walk is noise, not discrepancy
    walks = problem.each(lambda index: _Walk(by_noise, point, index))
    angles = problem.each(
        lambda index: walks[index].followed(uses, (turned.angles[index], problem.series[index].angles(ratio)))
    )
    return replace(turned, angles=tuple(angles))


class _Walk:
    """Angles of one recording beside a point of a fit."""

    def __init__(self, problem: Problem, point: Point, index: int) -> None:
        self.problem, self.point, self.index = problem, point, index
        self.one = problem.series[index]
        slots, sensor = point.hypothesis.packed()
        self.packed = slots[None], problem.sensors(index, [sensor])
        self.basis = problem.start_basis(index, point.hypothesis, point.starts[index])[2]

    def followed(self, uses: Sequence[EffectUse], begins: Sequence[Array]) -> Array:
        """The likeliest angles, n x 2, from the first of two to begin with unless the other is likelier."""
        first, other = begins
        likelier = _half_square(self._left(other)) < _half_square(self._left(first)) - _SETTLED
        angles = other if likelier else first
        for use in uses:
            angles = self._followed_by(use, angles)
        return angles

    def _followed_by(self, use: EffectUse, angles: Array) -> Array:
        side = EFFECTS[use.id].law.follows
        assert side is not None
        column, count = _COLUMNS[side], len(angles)
        knots = max(2, round(count * self.one.dt / _KNOTS_S) + 1)
        hats = _hats(count, knots)
        aside = _ASIDE_RAD / float(use.values["order"])
        rate = self._variance_a_second(side) * count * self.one.dt / (knots - 1)
        prior = np.diff(np.eye(knots), axis=0, prepend=np.eye(1, knots))[:, 1:] / np.sqrt(rate)
        base, walked = angles, np.zeros(knots - 1)
        left = self._left(angles)
        for _ in range(_ROUNDS):
            changes = []
            for hat in hats[1:]:  # where a recording begins its angle is known
                moved = angles.copy()
                moved[:, column] += aside * hat
                changes.append((self._left(moved) - left) / aside)
            slopes = np.array(changes)
            normal = slopes @ slopes.T + prior.T @ prior
            step = -np.linalg.solve(normal, slopes @ left + prior.T @ (prior @ walked))
            had = _half_square(left) + _half_square(prior @ walked)
            tried = []
            for part in _STEPS:
                there, moved = walked + part * step, base.copy()
                moved[:, column] += there @ hats[1:]
                stays = self._left(moved)
                tried.append((_half_square(stays) + _half_square(prior @ there), there, moved, stays))
            best = min(tried, key=lambda one: one[0])
            if best[0] > had - _SETTLED:
                break
            _, walked, angles, left = best
        return angles

    def _left(self, angles: Array) -> Array:
        """Weighed errors with such angles, without what starts could do."""
        one, (slots, sensors) = self.one, self.packed
        begins = begins_of(slots, self.point.starts[self.index][None])
        shown = simulate_many(slots, one.torque, one.dt, begins, sensors, one.block, angles, one.load)
        return without(self.basis, self.problem.weighed(self.index, one.measured - shown)[0])

    def _variance_a_second(self, side: Side) -> float:
        """Of the walk of an integrated speed with white noise, rad²/s; next to none of an angle."""
        ratio = gear_ratio_of(self.point.hypothesis.model()) or 1.0
        onto = np.array([1.0, ratio]) if side == "rotor" else np.array([1.0 / ratio, 1.0])
        recorded = np.isfinite(self.one.samples[0, :2])
        noise = np.where(recorded, self.problem.noise[:2] * onto, np.inf)
        if self.one.of_angle.any():
            noise[:2][self.one.of_angle[:2]] *= _NO_WALK
        return float(np.min(noise) ** 2 * self.one.block * self.one.dt)


def _hats(count: int, knots: int) -> Array:
    """Straight from one at its own knot to zero at the next ones: knots x samples."""
    places = np.linspace(0.0, knots - 1.0, count)
    return np.maximum(1.0 - np.abs(places - np.arange(knots)[:, None]), 0.0)


def _half_square(values: Array) -> float:
    return 0.5 * float(values @ values)
