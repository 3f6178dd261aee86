"""A race of effects: all that promise something are fitted beside a hypothesis, the hopeless given up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, cheapest, fit, fitted_on, started_from
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.evidence import rank
from hil.analysis.diagnosis.search.hidden_speeds import with_hidden_speeds
from hil.analysis.diagnosis.search.optional import little
from hil.analysis.diagnosis.search.places import width_of, with_likely_width
from hil.analysis.diagnosis.search.screen import Score
from hil.analysis.diagnosis.search.thresholds import (
    FAR,
    FREED_SIZES,
    IN_VAIN,
    LEAST_EVIDENCE,
    OUT_OF_RACE,
    PROMISING,
    RACE,
    RACE_ROUNDS,
    RACE_SLACK,
    RELATIVE_PROMISES,
    SIZES,
    STILL_FALLS,
)
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


@dataclass
class Step:
    """One step: what was tried on top of `parent`, best first.

    `predicted` is set where a promising effect makes parts of the recordings chaotic, and what was tried
    beside it says nothing then: the problem judged elsewhere alone, and the effect fitted there.
    """

    parent: Fit
    scores: list[Score]
    fits: list[Fit]
    predicted: tuple[Problem, Fit] | None = None
    #: Coordinates with the likeliest width of those effects for which it was looked for.
    widths: list[tuple[EffectUse, Array]] = field(default_factory=list)


def race(problem: Problem, step: Step, rivals: Sequence[Fit] = ()) -> None:
    """Fit the promising effects beside what `step` has; the hopeless are given up after a few rounds.

    The one that promises most is not, as long as it falls.

    Args:
        rivals: fits with as many effects beside other parents: the same effects are not fitted again where
            it makes no difference in which order they were found, and what is far behind one is hopeless.
    """
    first = len(step.fits)
    known = {one.hypothesis.keys[-1] for one in step.fits} if problem.partial else set()
    same = {frozenset(one.hypothesis.keys) for one in rivals if not one.hypothesis.remembers_place}
    for score in chosen(step.scores):
        if score.key in known or frozenset({*step.parent.hypothesis.keys, score.key}) in same:
            continue  # fitted already
        likely = next((theta for use, theta in step.widths if use == score.use), None)
        step.fits.append(grown(problem, step.parent, score.use, RACE_ROUNDS, likely))
    floor = float(problem.rows)
    _fallen(problem, step.fits, first)
    against = [*rivals, *(step.fits if problem.partial else step.fits[first:])]
    enough = OUT_OF_RACE * (min((f.total for f in against), default=floor) - floor) + RACE_SLACK
    if step.fits[first:] and step.fits[first].total - floor >= enough:
        step.fits[first] = _falling(problem, step.fits[first])  # numbers that were bent have a long way back
    for index, one in enumerate(step.fits[first:], first):
        if one.rounds >= RACE_ROUNDS and one.total - floor < enough:
            step.fits[index] = fitted_on(problem, one, enough=little(problem, one))


def _fallen(problem: Problem, fits: list[Fit], first: int) -> None:
    """Fits from number `first` on, those that still fall fitted on, where all are far from the noise.

    Abrupt effects with numbers that are far off take more rounds than smooth ones, and pass these.
    """
    if min((f.total for f in fits[first:]), default=0.0) < FAR * problem.rows:
        return
    for index, one in enumerate(fits[first:], first):
        fits[index] = _falling(problem, one)


def _falling(problem: Problem, one: Fit) -> Fit:
    """`one` fitted on as long as a few rounds more take off much."""
    while one.rounds >= RACE_ROUNDS:
        further = fitted_on(problem, one, rounds=RACE_ROUNDS)
        falls = further.total < STILL_FALLS * one.total
        one = further
        if not falls:
            break
    return one


def chosen(scores: list[Score]) -> list[Score]:
    """The scores whose effects are fitted, with those that look like them."""
    top = [s for s in scores[:RACE] if s.gain > max(LEAST_EVIDENCE, PROMISING * scores[0].gain)]
    wanted = {name for s in top[:2] for name in EFFECTS[s.key[0]].similar}
    have = {s.key[0] for s in top}
    return top + [
        s for s in scores if s.key[0] in wanted - have and s.gain > RELATIVE_PROMISES * scores[0].gain
    ]


def grown(problem: Problem, parent: Fit, use: EffectUse, rounds: int, likely: Array | None = None) -> Fit:
    """`parent` with one effect more, refitted from the most promising of a few sizes.

    The base model's parameters may have been bent to make up for what is missing: their nominal values are
    tried as well.

    Args:
        likely: coordinates with the likeliest width of a play, where they are known already.
    """
    hypothesis = beside_parent(parent, use)
    bent = started_from(parent, hypothesis)
    firsts = [bent] if hypothesis.far else [bent, nominal(hypothesis, bent)]
    tried = [t for theta in firsts for t in _sizes(hypothesis, theta)]
    likely = with_width(problem, parent, hypothesis) if likely is None else likely
    if likely is not None:
        tried.append(likely)
    first = cheapest(problem, hypothesis, tried, parent.starts, inert=parent.cost)
    starts = with_hidden_speeds(problem, hypothesis, first, parent.starts)
    return fit(problem, hypothesis, starts, first, rounds=rounds)


def freed(problem: Problem, parent: Fit, other: Fit) -> Fit:
    """The effects of `other` beside parameters as free as those of `parent`.

    Friction and play that were fitted beside wrong numbers are too large, and no slope leads back from a
    rotor that sticks: they begin at smaller sizes as well.
    """
    hypothesis = _either_way(replace(other.hypothesis, far=parent.hypothesis.far))
    theta = started_from(other, hypothesis)
    if not EFFECTS[hypothesis.ids[-1]].many_laws:
        return fit(problem, hypothesis, other.starts, theta)
    own = next(i for i, c in enumerate(hypothesis.coordinates()) if c.term == len(hypothesis.terms) - 1)
    sizes = [_sized(hypothesis, theta, own, factor) for factor in FREED_SIZES]
    lines = [fit(problem, hypothesis, other.starts, one, rounds=RACE_ROUNDS) for one in sizes]
    best = min(lines, key=rank)
    if best.total - problem.rows > IN_VAIN * (parent.total - problem.rows):
        return best
    return fit(problem, hypothesis, best.starts, best.theta)


def beside_parent(parent: Fit, use: EffectUse) -> Hypothesis:
    """The hypothesis of `parent` with one effect more, and those of its numbers open that are worth it."""
    hypothesis = with_moved(parent.hypothesis.with_term(use))
    return _either_way(hypothesis) if hypothesis.far else hypothesis


def _either_way(hypothesis: Hypothesis) -> Hypothesis:
    """With the optional numbers open that may have either sign, as that of uneven friction.

    Where all parameters are free these make up for such a number, and end where none is missed.
    """
    signed = {
        p.name
        for term in hypothesis.terms
        for p in EFFECTS[term.id].parameters
        if p.opens and p.lower < 0.0 < p.upper
    }
    return replace(hypothesis, open=tuple(sorted({*hypothesis.open, *signed})))


def with_width(problem: Problem, parent: Fit, hypothesis: Hypothesis) -> Array | None:
    """Coordinates with the likeliest width, where the newest effect of `hypothesis` is a play."""
    index = width_of(hypothesis)
    if index is None:
        return None
    bent = started_from(parent, hypothesis)
    theta = bent if hypothesis.far else nominal(hypothesis, bent)
    return with_likely_width(problem, hypothesis, theta, parent.starts, index)


def with_moved(hypothesis: Hypothesis) -> Hypothesis:
    """With the optional numbers of the newest effect open that its probe has off their defaults."""
    term = hypothesis.terms[-1]
    moved = {
        p.name
        for p in EFFECTS[term.id].parameters
        if p.optional and p.fitted and term.values[p.name] != p.default
    }
    return replace(hypothesis, open=tuple(sorted({*hypothesis.open, *moved})))


def nominal(hypothesis: Hypothesis, theta: Array) -> Array:
    """`theta` with the base model's parameters at their nominal values."""
    of_base = [c.term < 0 for c in hypothesis.coordinates()]
    return np.asarray(np.where(of_base, hypothesis.start(), theta))


def _sizes(hypothesis: Hypothesis, theta: Array) -> list[Array]:
    """`theta` with the newest effect smaller and larger, if it has but one number."""
    coordinates = hypothesis.coordinates()
    own = [i for i, c in enumerate(coordinates) if c.term == len(hypothesis.terms) - 1]
    if len(own) != 1:
        return [theta]
    return [_sized(hypothesis, theta, own[0], factor) for factor in SIZES]


def _sized(hypothesis: Hypothesis, theta: Array, index: int, factor: float) -> Array:
    """`theta` with its number `index` times a factor."""
    other, c = theta.copy(), hypothesis.coordinates()[index]
    size = theta[index] + np.log(factor) if c.scale == "log" else theta[index] * factor
    other[index] = np.clip(size, c.lower, c.upper)
    return other
