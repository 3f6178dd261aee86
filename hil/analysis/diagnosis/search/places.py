"""How wide a play is, read from what most of a recording says.

Least squares look at the largest errors, and those of a play lie where its motion is chaotic, or hang on
where in the play the axle stood as the recording began: there every width is as wrong as any other. The sum
of the logarithms of errors looks at the many stretches in which a width is right or wrong, and leads to the
right one from far (a redescending M-estimator: Holland and Welsch, Commun. Statist. A6, 1977).

How wide a play is where no one knows in which place of it the axle stood as a recording began.

What is seen of a play is when contact is met. That moves as much by another place at the start as by another
width, and sharply: between two widths, each with its places, lies a mountain of errors that no descent
crosses. So width and places are tried together. Steps that cross the play but once tell no more than the
way to the flank: widths that explain the data as well are the scatter of the one that is stated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize_scalar

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import SHAFT, Problem
from hil.analysis.diagnosis.search.evidence import Evidence, rank
from hil.analysis.diagnosis.search.thresholds import (
    AS_GOOD,
    MOST_OF_PLAY,
    PLACE_ROUNDS,
    PLACE_STEPS,
    PLACES_FINE,
    PLACES_MIDDLING,
    PLACES_NM,
    PLACES_TRIED,
    PLACES_WORTH,
    UNKNOWN_WIDTH,
    WIDTH_FINE,
    WIDTH_GRID,
    WIDTHS,
    WINDOW_OF_ERRORS_S,
)
from hil.core.chain import Chain
from hil.core.effects import EFFECTS, Law
from hil.plant import chain_numbers

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


@dataclass(frozen=True)
class _Starting:
    """A width with the places that suit it best, unfitted."""

    theta: Array
    starts: list[Array]
    total: float


@dataclass(frozen=True)
class Places:
    """The best of fits from other widths and places, and all of them; alone, where there is no width."""

    best: Fit
    fits: list[Fit]


def placed(evidence: Evidence, best: Fit) -> Fit:
    """The best of fits from other widths and places, with the scatter of those that are as good.

    `best` itself where its newest effect does not remember a place.
    """
    return most_likely(evidence, places_of(evidence, best))


def places_of(evidence: Evidence, best: Fit) -> Places:
    """Fits from other widths and places than those of `best`, where its newest effect remembers a place."""
    index = width_of(best.hypothesis)
    if index is None:
        return Places(best, [best])
    problem = evidence.problem.with_angles(best.angles)
    fits = [best]
    for _ in range(PLACE_ROUNDS):
        fits += _fitted(problem, best, _promising(problem, best, index))
        first = min(fits, key=rank)
        if rank(first) > (1.0 - AS_GOOD) * rank(best):
            break
        best = first
    return Places(min(fits, key=rank), fits)


def most_likely(evidence: Evidence, places: Places) -> Fit:
    """Of fits that explain the data as well the one that begins in the middle, with their scatter."""
    best, fits = places.best, places.fits
    index = width_of(best.hypothesis)
    if index is None:
        return best
    problem = evidence.problem.with_angles(best.angles)
    if max(abs(one.theta[index] - best.theta[index]) for one in _as_good(fits)) > UNKNOWN_WIDTH:
        middle = [_starting(problem, best, index, width) for width in _from_the_middle(problem, best, index)]
        likely = sorted(middle, key=lambda one: one.total)[:PLACES_TRIED]
        fits = fits + _fitted(problem, best, likely)
        best = min(_as_good(fits), key=lambda one: _off_the_middle(problem, one))
        return replace(best, scatter=np.max(_away(best, fits), axis=0))  # any of them, and those beyond
    return replace(best, scatter=np.sqrt(np.mean(_away(best, fits) ** 2, axis=0)))


def _away(best: Fit, fits: list[Fit]) -> Array:
    """How far the coordinates of fits that are as good lie from those of `best`: fits x coordinates."""
    return np.abs(np.stack([one.theta - best.theta for one in _as_good(fits)]))


def _fitted(problem: Problem, best: Fit, starting: list[_Starting]) -> list[Fit]:
    """Fits from there, all but the best ended after a few rounds."""
    first = [fit(problem, best.hypothesis, one.starts, one.theta, rounds=PLACE_STEPS) for one in starting]
    ranked = sorted(first, key=rank)
    return [fit(problem, best.hypothesis, one.starts, one.theta) for one in ranked[:1]] + ranked[1:]


def _promising(problem: Problem, best: Fit, index: int) -> list[_Starting]:
    """Other widths with their best places, and other places with this width; most promising first."""
    own = _middling(problem, best, index, 1.0)
    likely = [width for width in WIDTHS if _middling(problem, best, index, width) < PLACES_MIDDLING * own]
    lines = [_starting(problem, best, index, width) for width in likely]
    worth = [one for one in lines if one.total < PLACES_WORTH * best.total]
    elsewhere = _starting(problem, best, index, 1.0)
    if elsewhere.total < (1.0 - AS_GOOD) * best.total:
        worth.append(elsewhere)
    return sorted(worth, key=lambda one: one.total)[:PLACES_TRIED]


def _middling(problem: Problem, best: Fit, index: int, width: float) -> float:
    """What `best` with its width times `width` leaves in half of all windows.

    Where a play forgets how it began, no place makes a wrong width right.
    """
    theta = best.theta.copy()
    theta[index] += np.log(width)
    return float(np.median(window_errors(problem, best.hypothesis, theta, best.starts)))


def _starting(problem: Problem, best: Fit, index: int, width: float) -> _Starting:
    """`best` with its width times `width`, every recording started where that suits it best."""
    theta = best.theta.copy()
    theta[index] += np.log(width)
    point, play = best.hypothesis.packed(theta), _Play.of(best, index)
    total, starts = best.prior, []
    for trace, start in enumerate(best.starts):
        places = [start[SHAFT], *PLACES_NM, *play.same_ways(width, float(start[SHAFT]))]
        tried = np.tile(start, (len(places), 1))
        tried[:, SHAFT] = places
        cheapest, cost = problem.cheapest_start(trace, point, tried)
        total += cost
        starts.append(cheapest)
    return _Starting(theta, starts, total)


def _from_the_middle(problem: Problem, best: Fit, index: int) -> list[float]:
    """Widths with which a recording that begins at rest has the same way to a flank from the middle."""
    play = _Play.of(best, index)
    torques = [float(s[SHAFT]) for s, rests in zip(best.starts, problem.resting, strict=True) if rests]
    shares = [play.place(torque, 1.0) / play.gap for torque in torques]
    return sorted({1.0 + way for share in shares for way in (-share, share) if way > -MOST_OF_PLAY})


@dataclass(frozen=True)
class _Play:
    """The play of a fit: its law, the chain that it is in, its numbers, and which of them is its width."""

    law: Law
    chain: Chain
    numbers: tuple[float, ...]
    width: int

    @classmethod
    def of(cls, best: Fit, index: int) -> _Play:
        model, name = best.hypothesis.model(best.theta), best.hypothesis.coordinates()[index].name
        effect = EFFECTS[best.hypothesis.ids[-1]]
        values = effect.completed(model.effects[-1].values)
        names = [parameter.name for parameter in effect.parameters]
        numbers = tuple(float(values[each]) for each in names)
        return cls(effect.law, chain_numbers(model), numbers, names.index(name))

    @property
    def gap(self) -> float:
        return self.numbers[self.width]

    def place(self, torque: float, width: float) -> float:
        """Where in this play times `width` a torque begins."""
        numbers = list(self.numbers)
        numbers[self.width] *= width
        assert self.law.begin is not None
        return float(self.law.begin(torque, self.chain, tuple(numbers)))

    def same_ways(self, width: float, torque: float) -> list[float]:
        """Torques whose places in another width are as far from one flank, or the other, as before."""
        now = self.place(torque, 1.0)
        torques = np.linspace(PLACES_NM[0], PLACES_NM[-1], PLACES_FINE)
        places = [self.place(t, width) for t in torques]
        return [
            float(np.interp(now + side * (width - 1.0) * self.gap, places, torques)) for side in (-1.0, 1.0)
        ]


def _as_good(fits: list[Fit]) -> list[Fit]:
    """Those that explain the data as well as the best."""
    least = min(rank(one) for one in fits)
    return [one for one in fits if rank(one) < (1.0 + AS_GOOD) * least]


def _off_the_middle(problem: Problem, one: Fit) -> float:
    """How far off the middle of the play those recordings begin that begin at rest; else what is left."""
    resting = [start[SHAFT] ** 2 for start, rests in zip(one.starts, problem.resting, strict=True) if rests]
    return float(sum(resting)) if resting else rank(one)
