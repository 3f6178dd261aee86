"""How much of a gap a fit leaves, what its numbers cost, and how firmly one fit is preferred to another."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.coherence import Split, split
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.thresholds import (
    ALL_BUT,
    ALL_BUT_NOISES,
    DOUBT,
    EARLY,
    FAR,
    LAWS_DIFFER,
    NEARLY_ALL,
    NOTHING,
    PRICE,
    SIGMAS,
    SMALL,
    SMALLISH,
    WHITE_AT_LEAST,
)
from hil.core.effects import EFFECTS, Stage

_SENSOR_FAULTS = tuple(e.id for e in EFFECTS.values() if e.stage is Stage.SENSOR)


def price(one: Fit) -> float:
    """What the numbers of a fit cost, in squared errors over the noise variance."""
    return PRICE * len(one.theta)


def rank(one: Fit) -> float:
    """Total and a price of every number: smaller is better.

    Far from the noise formulas differ, and a small advantage of a fault in a sensor says nothing. No channel
    is recorded before it happens: where dead time is free, one that is early is as good as another that is
    late.
    """
    if doubted(one):
        return DOUBT * one.total + price(one)
    return (EARLY if _early(one) else 1.0) * one.total + price(one)


def doubted(one: Fit) -> bool:
    """Whether a fault in a sensor is among the names, and so much is left that formulas differ."""
    return one.total > FAR * one.rows and any(id_ in _SENSOR_FAULTS for id_ in one.hypothesis.ids)


def _early(one: Fit) -> bool:
    """Whether a channel is recorded early."""
    coordinates = one.hypothesis.coordinates()
    return any(c.name == "delay_s" and value < 0.0 for c, value in zip(coordinates, one.theta, strict=True))


Array = npt.NDArray[np.float64]

_SPAN = {1: 1, 2: 1, 3: 1.5, 5: 2.5, 8: 4, 13: 6.5, 21: 8}


@dataclass
class Evidence:
    """Judges fits of one problem by what they leave.

    `rounding` is the power per channel that rounding of its readings leaves, in noise variances.
    """

    problem: Problem
    base: Fit
    rounding: Array = field(default_factory=lambda: np.zeros(3))
    _splits: dict[int, tuple[Fit, Split]] = field(default_factory=dict, repr=False)

    def split(self, one: Fit) -> Split:
        """Physics and noise in the errors of a fit."""
        known = self._splits.get(id(one))
        if known is None or known[0] is not one:
            known = (one, split_of(self.problem, one))
            self._splits[id(one)] = known
        return known[1]

    def physics(self, one: Fit) -> Array:
        """Power of what is not noise in each channel, noise variances of a single reading."""
        return np.asarray(np.maximum(self.split(one).physics - self.rounding, 0.0))

    def left(self, one: Fit) -> float:
        """The same over all channels."""
        return float(np.sum(self.physics(one)))

    def closed(self, one: Fit) -> bool:
        """Whether nothing but noise is left, in every channel."""
        parts = self.split(one)
        limit = np.maximum(SIGMAS * parts.deviation, NOTHING * np.maximum(parts.noise, 1.0))
        return bool(np.all(self.physics(one) <= limit))

    def settled(self, one: Fit) -> bool:
        """Whether so little is left that a formula differs, and no further effect is missing."""
        if self.closed(one):
            return True
        worst = self.worst(one)
        little = LAWS_DIFFER if one.hypothesis.of_many_laws else SMALLISH
        return self.all_but(one) or (
            bool(one.hypothesis.terms)
            and (worst < SMALL or (worst < little and self.share(one) > NEARLY_ALL))
        )

    def all_but(self, one: Fit) -> bool:
        """Whether an effect of many laws closes so much of so large a gap that time steps decide the rest.

        Contact comes and goes between samples, which a fit that moves by samples misses a little.
        """
        return one.hypothesis.of_many_laws and self.share(one) > ALL_BUT and self.worst(one) < ALL_BUT_NOISES

    def colouring(self, one: Fit) -> Array:
        """Standard deviation of each channel's noise over that of its white part, shape (3,).

        Slow noise does not average out within a block as white noise does.
        """
        block = self.problem.traces[0].block
        return np.asarray(np.sqrt(1.0 + np.maximum(self.split(one).noise - 1.0, 0.0) / block))

    def share(self, one: Fit) -> float:
        """Share of the base model's gap that a fit closes."""
        whole = self.left(self.base)
        return 1.0 - self.left(one) / whole if whole > 0.0 else 0.0

    def gaps(self, one: Fit) -> Array:
        """Gap over noise floor of each channel, shape (3,), 1 for noise alone and where not measured."""
        noise = np.maximum(self.split(one).noise, 1.0)
        return np.asarray(np.sqrt(1.0 + self.physics(one) / noise))

    def worst(self, one: Fit) -> float:
        """Gap over noise floor of the channel that is worst off, 1 for noise alone."""
        return float(np.max(self.gaps(one)))

    def between(self, poorer: Fit, richer: Fit) -> float:
        """Twice the log-likelihood ratio, deflated by the correlation time of the richer fit's errors."""
        ratio = max(poorer.total, 1.0) / max(richer.total, 1.0)
        return float(self.problem.rows * np.log(max(ratio, 1e-9)) / colour(richer))


def split_of(problem: Problem, one: Fit) -> Split:
    """Physics and noise in the errors of a fit, no more noise than is proven, no less than is white."""
    parts = split(problem.traces, problem.weights, [errors.channels for errors in one.errors])
    white = np.nan_to_num(np.minimum(problem.floor / problem.noise, 1.0)) ** 2
    return parts.within(problem.proven, WHITE_AT_LEAST * white)


def colour(one: Fit) -> float:
    """How many neighbouring errors count as one: 1 for white errors, more for coloured ones."""
    rise, power = 0.0, 0.0
    for errors in one.errors:
        e = errors.channels
        power += float(np.sum(e * e))
        for lag in (1, 2, 3, 5, 8, 13, 21):
            rise += _SPAN[lag] * float(np.sum(e[lag:] * e[:-lag]))
    return max(1.0, 1.0 + 2.0 * rise / max(power, 1e-12))
