"""One step of a search: a hypothesis with each further effect that promises something, fitted.

All effects are scored linearly, the promising few run a race of fits, the winner is fitted with care: from
other sizes, with optional numbers, with angles aligned.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._fit import Fit, carried, cheapest, fit
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.search._alignment import adds_ripple, aligned
from hil.analysis.diagnosis.search._evidence import Evidence
from hil.analysis.diagnosis.search._foretold import where_foretold
from hil.analysis.diagnosis.search._forms import by_other_laws
from hil.analysis.diagnosis.search._hidden_speeds import with_hidden_speeds
from hil.analysis.diagnosis.search._optional import little, refined
from hil.analysis.diagnosis.search._places import placed
from hil.analysis.diagnosis.search._rank import price, rank
from hil.analysis.diagnosis.search._screen import Score, screen
from hil.analysis.diagnosis.search._thresholds import (
    CONTENDER,
    FAR,
    HOPE,
    LEAST_EVIDENCE,
    NEARLY,
    OTHER_SIZES,
    OUT_OF_RACE,
    PLAIN,
    PROMISING,
    RACE,
    RACE_ROUNDS,
    RACE_SLACK,
    RELATIVE_PROMISES,
    SIZES,
    WORTH_POLISH,
)
from hil.analysis.diagnosis.search._tracking import RIPPLES, tracked_gain
from hil.analysis.diagnosis.search._width import width_of, with_likely_width
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


@dataclass
class Step:
    """One step: what was tried on top of `parent`, best first.

    `foretold` is set where a promising effect makes parts of the recordings chaotic, and what was tried
    beside it says nothing then: the problem judged elsewhere alone, and the effect fitted there.
    """

    parent: Fit
    scores: list[Score]
    fits: list[Fit]
    foretold: tuple[Problem, Fit] | None = None


def grow(
    evidence: Evidence, step: Step, scores: list[Score] | None = None, beside: Sequence[Fit] = ()
) -> None:
    """Try the parent of `step` with each promising further effect; it gets what is found as that is known.

    Args:
        scores: of `screen`, where these are known already.
        beside: fits with one effect more that other numbers led to, to be fitted on from where they are.
    """
    parent = step.parent
    if adds_ripple(parent.hypothesis):
        problem = evidence.problem.with_angles(parent.angles)
    else:
        problem = evidence.problem.following(parent.hypothesis, parent.theta)
    blocks = problem.rows / max(problem.channels, 1)
    scores = screen(problem, parent) if scores is None else scores
    if not problem.partial:
        step.foretold = _foretold(problem, parent, scores)
        if step.foretold:
            return
    step.fits += [_freed(problem, parent, one) for one in beside]
    found = any(evidence.share(one) > NEARLY for one in step.fits)
    if not found and (not scores or scores[0].gain < PLAIN * evidence.left(parent) * blocks):
        if not parent.hypothesis.far:  # far numbers say nothing of what is missing
            scores = _better(scores, screen(problem, _straightened(problem, parent), parent.total))
        scores = _better(scores, _followed(problem, parent, scores))
    step.scores += scores
    if not scores or scores[0].gain >= max(HOPE * evidence.left(parent) * blocks, LEAST_EVIDENCE):
        _race(problem, step)
    step.fits.sort(key=lambda f: f.total + price(f))
    if step.fits:
        step.fits[:] = _contended(problem, evidence, step.fits)
        best = aligned(problem, step.fits[0])
        if not problem.partial and width_of(best.hypothesis) is not None and not evidence.closed(best):
            step.foretold = where_foretold(problem, parent, best, fitted=True)
            if step.foretold:
                return
        step.fits[0] = _polished(evidence, best)


def _freed(problem: Problem, parent: Fit, other: Fit) -> Fit:
    """The effects of `other` beside parameters as free as those of `parent`."""
    hypothesis = _either_way(replace(other.hypothesis, far=parent.hypothesis.far))
    return fit(problem, hypothesis, other.starts, carried(other, hypothesis))


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


def _contended(problem: Problem, evidence: Evidence, fits: list[Fit]) -> list[Fit]:
    """`fits`, best first, the best with its optional numbers; far from the noise all that come near it.

    Friction that pulls one way more than the other is not seen by its even part alone.
    """
    floor = float(problem.rows)
    if evidence.all_but(fits[0]):
        return fits
    if fits[0].total < FAR * floor:
        return [refined(problem, evidence, fits[0]), *fits[1:]]
    least = CONTENDER * (fits[0].total - floor) + floor
    contenders = [refined(problem, evidence, one) for one in fits if one.total < least]
    return sorted([*contenders, *fits[len(contenders) :]], key=rank)


def _followed(problem: Problem, parent: Fit, scores: list[Score]) -> list[Score]:
    """Ripples by what they promise once their phase is followed."""
    ripples = [s.use for s in scores if s.key[0] in RIPPLES and s.gain > LEAST_EVIDENCE]
    return [Score(use, tracked_gain(problem, parent, use)) for use in ripples]


def _straightened(problem: Problem, parent: Fit) -> Fit:
    """`parent` with nominal base parameters: bent ones make up for what is missing, and hide it."""
    nominal = _nominal(parent.hypothesis, parent.theta)
    return fit(problem, parent.hypothesis, parent.starts, nominal, rounds=0)


def _nominal(hypothesis: Hypothesis, theta: Array) -> Array:
    """`theta` with the base model's parameters at their nominal values."""
    of_base = [c.term < 0 for c in hypothesis.coordinates()]
    return np.asarray(np.where(of_base, hypothesis.start(), theta))


def _better(scores: list[Score], others: list[Score]) -> list[Score]:
    """Every effect by the better of two scores, most promising first."""
    best = {score.key: score for score in others}
    for score in scores:
        if score.key not in best or best[score.key].gain < score.gain:
            best[score.key] = score
    return sorted(best.values(), key=lambda s: -s.gain)


def _foretold(problem: Problem, parent: Fit, scores: list[Score]) -> tuple[Problem, Fit] | None:
    """Where the promising effects foretell the motion: the first that does not everywhere, fitted there."""
    for score in _chosen(scores):
        hypothesis = _with_moved(parent.hypothesis.with_term(score.use))
        theta = _with_width(problem, parent, hypothesis)
        if theta is None:
            continue
        one = fit(problem, hypothesis, parent.starts, theta, rounds=0)
        if found := where_foretold(problem, parent, one):
            return found
    return None


def _with_width(problem: Problem, parent: Fit, hypothesis: Hypothesis) -> Array | None:
    """Coordinates with the likeliest width, where the newest effect of `hypothesis` is a play."""
    index = width_of(hypothesis)
    if index is None:
        return None
    bent = carried(parent, hypothesis)
    theta = bent if hypothesis.far else _nominal(hypothesis, bent)
    return with_likely_width(problem, hypothesis, theta, parent.starts, index)


def _race(problem: Problem, step: Step) -> None:
    """Fit the promising effects beside what `step` has; the hopeless are given up after a few rounds."""
    first = len(step.fits)
    known = {one.hypothesis.keys[-1] for one in step.fits} if problem.partial else set()
    for score in _chosen(step.scores):
        if score.key in known:
            continue  # fitted already, with more care
        step.fits.append(grown(problem, step.parent, score.use, RACE_ROUNDS))
    floor = float(problem.rows)
    against = step.fits if problem.partial else step.fits[first:]
    best = min((f.total for f in against), default=floor)
    for index, one in enumerate(step.fits[first:], first):
        if one.rounds >= RACE_ROUNDS and one.total - floor < OUT_OF_RACE * (best - floor) + RACE_SLACK:
            enough = little(problem, one)
            step.fits[index] = fit(problem, one.hypothesis, one.starts, one.theta, enough=enough)


def _chosen(scores: list[Score]) -> list[Score]:
    top = [s for s in scores[:RACE] if s.gain > max(LEAST_EVIDENCE, PROMISING * scores[0].gain)]
    wanted = {name for s in top[:2] for name in EFFECTS[s.key[0]].kin}
    have = {s.key[0] for s in top}
    return top + [
        s for s in scores if s.key[0] in wanted - have and s.gain > RELATIVE_PROMISES * scores[0].gain
    ]


def grown(problem: Problem, parent: Fit, use: EffectUse, rounds: int) -> Fit:
    """`parent` with one effect more, refitted from the most promising of a few sizes.

    The base model's parameters may have been bent to make up for what is missing: their nominal values are
    tried as well.
    """
    hypothesis = _with_moved(parent.hypothesis.with_term(use))
    if hypothesis.far:
        hypothesis = _either_way(hypothesis)
    bent = carried(parent, hypothesis)
    firsts = [bent] if hypothesis.far else [bent, _nominal(hypothesis, bent)]
    tried = [t for theta in firsts for t in _sizes(hypothesis, theta)]
    likely = _with_width(problem, parent, hypothesis)
    if likely is not None:
        tried.append(likely)
    first = cheapest(problem, hypothesis, tried, parent.starts, inert=parent.cost)
    starts = with_hidden_speeds(problem, hypothesis, first, parent.starts)
    return fit(problem, hypothesis, starts, first, rounds=rounds)


def _with_moved(hypothesis: Hypothesis) -> Hypothesis:
    """With the optional numbers of the newest effect open that its probe has off their defaults."""
    term = hypothesis.terms[-1]
    moved = {
        p.name
        for p in EFFECTS[term.id].parameters
        if p.optional and p.fitted and term.values[p.name] != p.default
    }
    return replace(hypothesis, open=tuple(sorted({*hypothesis.open, *moved})))


def _sizes(hypothesis: Hypothesis, theta: Array) -> list[Array]:
    """`theta` with the newest effect smaller and larger, if it has but one number."""
    coordinates = hypothesis.coordinates()
    own = [i for i, c in enumerate(coordinates) if c.term == len(hypothesis.terms) - 1]
    if len(own) != 1:
        return [theta]
    found = []
    for factor in SIZES:
        other = theta.copy()
        c = coordinates[own[0]]
        size = theta[own[0]] + np.log(factor) if c.scale == "log" else theta[own[0]] * factor
        other[own[0]] = np.clip(size, c.lower, c.upper)
        found.append(other)
    return found


def _polished(evidence: Evidence, best: Fit) -> Fit:
    """From other sizes of the newest effect: abrupt effects have false minima."""
    effect = EFFECTS[best.hypothesis.ids[-1]]
    if not effect.abrupt or evidence.share(best) < WORTH_POLISH:
        return best
    if (
        not evidence.all_but(best) and not evidence.settled(best) and not best.hypothesis.far
    ):  # far numbers have no nominal ones
        own = next(
            i for i, c in enumerate(best.hypothesis.coordinates()) if c.term == len(best.hypothesis.terms) - 1
        )
        best = _from_sizes(evidence, best, _nominal(best.hypothesis, best.theta), own, OTHER_SIZES)
    return by_other_laws(evidence, best if evidence.problem.partial else placed(evidence, best))


def _from_sizes(evidence: Evidence, best: Fit, theta: Array, index: int, factors: tuple[float, ...]) -> Fit:
    """The best of `best` and of fits from `theta` with its number `index` times each factor."""
    problem = evidence.problem.with_angles(best.angles)
    for factor in factors:
        other = theta.copy()
        other[index] += np.log(factor)
        starts, enough = evidence.base.starts, little(problem, best)
        best = min(best, fit(problem, best.hypothesis, starts, other, enough=enough), key=rank)
    return best
