"""What changes of outputs promise beside what all numbers and starts of a point could do.

The change d of the weighed outputs against the misfit r has the bounded solution of a linear regression
(score test, C. R. Rao, Proc. Cambridge Phil. Soc. 44 (1948) 50). What it promises is the growth of log L
where so much is taken off, octave by octave, beyond what the numbers would take off alone. An octave that
ends in noise holds as many values as it has bins, so that it is weighed again by what is left of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._fit import Linearised, without
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._odds import ALIKE
from hil.analysis.missing_effects._problem import Problem
from hil.core.effects import Direction

Array = npt.NDArray[np.float64]

_SWEEPS = 20  # of coordinate descent over at most two bounded factors
_ROUNDS = 6
_SETTLED = 0.1  # growth of log L between rounds that ends them


@dataclass(frozen=True)
class Products:
    """Of weighed changes (k), slopes of the numbers and the misfit with each other: by octaves, and the rest.

    3 x bands of (k + numbers + 1) squared, and that. `abrupt`: whose outputs do not go straight.
    """

    abrupt: tuple[bool, ...]
    octaves: Array
    rest: Array

    @property
    def count(self) -> int:
        """How many changes."""
        return len(self.abrupt)


@dataclass(frozen=True)
class Explained:
    """Factors of directions, moves of the numbers beside them, and growth of log L that they promise."""

    factors: list[float]
    moves: Array
    gain: float


class Projection:
    """Simulates additions to a fitted hypothesis beside what its numbers and starts can do."""

    def __init__(self, problem: Problem, at: Linearised) -> None:
        self.problem, self.at = problem, at
        packed = [at.point.hypothesis.packed()]
        self.plain = problem.each(lambda i: problem.simulated(i, packed, at.point.starts[i][None])[0])
        self.ends = np.cumsum([0, *map(len, at.bases)]).tolist()
        self.powers = at.point.powers(problem)
        self.is_far = problem.log_prior(at.point.hypothesis) < -ALIKE

    def products(self, hypotheses: Sequence[Hypothesis]) -> Products:
        """Of the changes that hypotheses make, recording by recording."""
        packed = [one.packed() for one in hypotheses]

        def of(index: int) -> tuple[Array, Array]:
            starts = np.repeat(self.at.point.starts[index][None], len(packed), axis=0)
            shown = self.problem.simulated(index, packed, starts, keep=False)
            change = self.problem.weighed(index, shown - self.plain[index])
            without(self.at.bases[index], change.T)
            return self._products(index, change)

        octaves, rest = (sum(parts) for parts in zip(*self.problem.each(of), strict=True))
        return Products(tuple(one.is_abrupt for one in hypotheses), octaves, rest)

    @cached_property
    def alone(self) -> Explained:
        """What the numbers promise without anything that joins them."""
        each = self.problem.each(
            lambda index: self._products(index, np.empty((0, len(self.at.bases[index]))))
        )
        octaves, rest = (sum(parts) for parts in zip(*each, strict=True))
        return self._taken_off(Products((), octaves, rest), slice(0), ())

    def _products(self, index: int, change: Array) -> tuple[Array, Array]:
        """Of changes of a recording's weighed outputs, slopes of the numbers, and the misfit."""
        here = slice(*self.ends[index : index + 2])
        rows = np.concatenate([change, self.at.slopes[here].T, self.at.left[None, here]])
        return self.problem.by_octave(index, rows)

    def explained(self, of: Products, which: slice, directions: Sequence[Direction]) -> Explained:
        """The best factors of directions within bounds.

        Args:
            which: of the hypotheses, the directions at their size.
        """
        found = self._taken_off(of, which, directions)
        return replace(found, gain=found.gain - max(self.alone.gain, 0.0))

    def _taken_off(self, of: Products, which: slice, directions: Sequence[Direction]) -> Explained:
        """What directions and numbers take off together.

        Numbers that are far from their base's may come back as a joining effect lets them: then it is also
        looked for without the prior's pull, which holds what the data do not tell.
        """
        ways = [self._taken_off_held(of, which, directions, held=True)]
        if self.is_far:
            ways.append(self._taken_off_held(of, which, directions, held=False))
        return max(ways, key=lambda one: one.gain)

    def _taken_off_held(
        self, of: Products, which: slice, directions: Sequence[Direction], *, held: bool
    ) -> Explained:
        """What directions and numbers take off, these held by their prior or not.

        Each round weighs octaves by what the one before left of them, as those of a fit do. Where outputs do
        not go straight so much is not known: one round.
        """
        rows = np.arange(len(of.rest))
        parts = np.concatenate([rows[which], rows[of.count :]])
        octaves, rest = (matrix[..., parts[:, None], parts] for matrix in (of.octaves, of.rest))
        if not (np.all(np.isfinite(octaves)) and np.all(np.isfinite(rest))):
            return Explained([1.0] * len(directions), np.zeros(len(self.at.coordinates)), -math.inf)
        noise, changes = self.problem.noise, slice(0, len(directions))
        numbers, misfit = slice(len(directions), -1), -1
        prior = np.column_stack([one[self.ends[-1] :] for one in (self.at.slopes, self.at.left)])
        if held:
            rest[len(directions) :, len(directions) :] += prior.T @ prior
        had, stays = octaves[..., misfit, misfit], np.ones(octaves.shape[:2])
        best = Explained([1.0] * len(directions), np.zeros(len(self.at.coordinates)), -math.inf)
        for _ in range(1 if any(of.abrupt[which]) else _ROUNDS):
            weights = self.powers.weights(noise, stays)
            both = rest + np.tensordot(weights, octaves, 2)
            inverse = np.linalg.pinv(both[numbers, numbers], hermitian=True)
            taken = inverse @ both[numbers, changes]
            normal = both[changes, changes] - both[changes, numbers] @ taken
            right = both[changes, misfit] - taken.T @ both[numbers, misfit]
            factors = _regressed(normal, right, directions)
            moves = taken @ factors - inverse @ both[numbers, misfit]
            rows = np.concatenate([-factors, moves, [1.0]])
            has = octaves @ rows @ rows
            stays = np.where(had > 0.0, np.maximum(has, 0.0) / np.maximum(had, 1e-300), 1.0)
            within = np.clip(moves, -1.0, 1.0)  # a factor e at most
            away = prior @ rows[len(directions) :]
            if self.is_far:
                away = self.problem.prior(self.at.coordinates, within)
            gain = self.powers.growth(noise, stays) + 0.5 * float(np.sum(prior[:, -1] ** 2) - np.sum(away**2))
            if gain < best.gain + _SETTLED:
                break
            best = Explained(factors.tolist(), within, gain)
        return best


def _regressed(normal: Array, right: Array, directions: Sequence[Direction]) -> Array:
    """Factors within the directions' bounds that take most off."""
    factors = np.clip(np.ones(len(directions)), [o.lower for o in directions], [o.upper for o in directions])
    for _ in range(_SWEEPS if len(directions) > 1 else 1):
        for i, one in enumerate(directions):
            rest = right[i] - normal[i] @ factors + normal[i, i] * factors[i]
            factors[i] = min(max(rest / max(normal[i, i], 1e-300), one.lower), one.upper)
    return np.asarray(factors)
