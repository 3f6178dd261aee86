"""One step of a search: a hypothesis with each further effect that promises something, fitted.

All effects are scored linearly, the promising few run a race of fits, the winner is fitted with care: from
other sizes, with optional numbers, with angles aligned.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.alignment import adds_ripple, aligned
from hil.analysis.diagnosis.search.evidence import Evidence, price, rank
from hil.analysis.diagnosis.search.forms import by_likeliest_law, by_other_laws
from hil.analysis.diagnosis.search.hopping import hopped
from hil.analysis.diagnosis.search.optional import promising, refined
from hil.analysis.diagnosis.search.places import most_likely, places_of
from hil.analysis.diagnosis.search.predictable import where_predicted
from hil.analysis.diagnosis.search.race import Step, beside_parent, chosen, freed, nominal, race, with_width
from hil.analysis.diagnosis.search.screen import Score, screen
from hil.analysis.diagnosis.search.thresholds import (
    AS_GOOD,
    CONTENDER,
    FALSE_MINIMUM,
    FAR,
    FORM_FROM,
    HOPE,
    HOPE_FURTHER,
    LEAST_EVIDENCE,
    NEARLY,
    OTHER_SIZES,
    PLAIN,
    PREDICTED_LEAVES,
    STRAIGHT,
    WORTH_POLISH,
)
from hil.analysis.diagnosis.search.tracking import RIPPLES, tracked_gain
from hil.analysis.diagnosis.search.trimmed import trimmed
from hil.core.effects import EFFECTS

Array = npt.NDArray[np.float64]


def grow(
    evidence: Evidence,
    step: Step,
    scores: list[Score] | None = None,
    beside: Sequence[Fit] = (),
    rivals: Sequence[Fit] = (),
    *,
    everywhere: bool = False,
) -> None:
    """Try the parent of `step` with each promising further effect; it gets what is found as that is known.

    Args:
        scores: of `screen`, where these are known already.
        beside: fits with one effect more that other numbers led to, to be fitted on from where they are.
        rivals: fits with as many effects that were found beside other parents.
        everywhere: errors count in all of the recordings, whatever an effect predicts.
    """
    parent = step.parent
    problem = _problem_of(evidence, parent)
    blocks = problem.rows / max(problem.channels, 1)
    scores = screen(problem, parent) if scores is None else scores
    if not (problem.partial or everywhere):
        step.predicted = _predicted(problem, step, scores)
        if step.predicted:
            return
    step.fits += [freed(problem, parent, one) for one in beside]
    found = any(evidence.share(one) > NEARLY for one in (*step.fits, *rivals))
    if not found and (not scores or scores[0].gain < PLAIN * evidence.left(parent) * blocks):
        if not parent.hypothesis.far:  # far numbers say nothing of what is missing
            scores = _better(scores, _scored_straightened(problem, parent))
        scores = _better(scores, _followed(problem, parent, scores))
    step.scores += scores
    hope = HOPE_FURTHER if parent.hypothesis.terms else HOPE
    if not scores or scores[0].gain >= max(hope * evidence.left(parent) * blocks, LEAST_EVIDENCE):
        race(problem, step, rivals)
        if not parent.hypothesis.terms:
            step.fits += _of_other_laws(evidence, step.fits)
    step.fits.sort(key=lambda f: f.total + price(f))


def finish(evidence: Evidence, step: Step, *, everywhere: bool = False) -> None:
    """The best fit of `step` taken on with care: optional numbers, angles, other sizes, places and laws."""
    problem = _problem_of(evidence, step.parent)
    step.fits[:] = _contended(problem, evidence, step.fits)
    best = aligned(problem, step.fits[0])
    sought = not (problem.partial or everywhere)
    if sought and best.hypothesis.remembers_place and not evidence.settled(best):
        best, step.predicted = _predicted_at_best(problem, evidence, best)
        if step.predicted:
            return
    step.fits[0] = _past_false_minima(evidence, _polished(evidence, best))


def _past_false_minima(evidence: Evidence, best: Fit) -> Fit:
    """`best`; of a play that closes nearly all, and leaves little but not noise, the lowest near it."""
    little = evidence.share(best) > NEARLY and best.total < FALSE_MINIMUM * best.rows
    return hopped(evidence.problem, best) if little and not evidence.settled(best) else best


def _problem_of(evidence: Evidence, parent: Fit) -> Problem:
    """The problem with the angles that ripples beside `parent` follow."""
    if adds_ripple(parent.hypothesis):
        return evidence.problem.with_angles(parent.angles)
    return evidence.problem.following(parent.hypothesis, parent.theta)


def _of_other_laws(evidence: Evidence, fits: list[Fit]) -> list[Fit]:
    """Effects that lost a race that no one won, by the laws of other authors.

    Flanks that pull, met by some that do not, explain less than a damping that is wrong elsewhere.
    """
    best = min(fits, key=rank, default=None)
    if best is None or evidence.settled(best) or evidence.share(best) > NEARLY:
        return []
    with_forms = [one for one in fits if EFFECTS[one.hypothesis.ids[-1]].forms]
    likeliest = min(with_forms, key=rank, default=best)
    if likeliest is best or evidence.share(likeliest) < WORTH_POLISH:
        return []
    return [by_likeliest_law(evidence, likeliest)]


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


def _scored_straightened(problem: Problem, parent: Fit) -> list[Score]:
    """Scores beside nominal base parameters: bent ones make up for what is missing, and hide it.

    None where nominal ones leave so much that derivatives say nothing of what is missing beside them.
    """
    theta = nominal(parent.hypothesis, parent.theta)
    plain = fit(problem, parent.hypothesis, parent.starts, theta, rounds=0)
    if plain.total - problem.rows > STRAIGHT * max(parent.total - problem.rows, 0.0):
        return []
    return screen(problem, plain, parent.total)


def _better(scores: list[Score], others: list[Score]) -> list[Score]:
    """Every effect by the better of two scores, most promising first."""
    best = {score.key: score for score in others}
    for score in scores:
        if score.key not in best or best[score.key].gain < score.gain:
            best[score.key] = score
    return sorted(best.values(), key=lambda s: -s.gain)


def _predicted(problem: Problem, step: Step, scores: list[Score]) -> tuple[Problem, Fit] | None:
    """Where the promising effects predict the motion: the first that does not everywhere, fitted there."""
    parent = step.parent
    for score in chosen(scores):
        hypothesis = beside_parent(parent, score.use)
        theta = with_width(problem, parent, hypothesis)
        if theta is None:
            continue
        step.widths.append((score.use, theta))
        one = fit(problem, hypothesis, parent.starts, theta, rounds=0)
        if found := where_predicted(problem, parent, one):
            return found
    return None


def _predicted_at_best(
    problem: Problem, evidence: Evidence, best: Fit
) -> tuple[Fit, tuple[Problem, Fit] | None]:
    """`best`, and where alone it predicts the motion, if it does not nearly everywhere.

    A play that begins in the wrong place leaves as much, in the same few windows, as one that is chaotic
    there: before these are given up it is tried from other places. And a play that was bent for them, or for
    an effect found after it, does not show them: its numbers are taken from where they do not matter.
    """
    found = where_predicted(problem, evidence.base, best, fitted=True)
    if found is None:
        found = where_predicted(problem, evidence.base, trimmed(problem, best), fitted=True)
        less = found is not None and _by_row(found[1]) < PREDICTED_LEAVES * _by_row(best)
        return best, found if less else None
    other = places_of(evidence, best).best
    if rank(other) >= (1.0 - AS_GOOD) * rank(best):
        return best, found
    if evidence.settled(other):
        return other, None
    return other, where_predicted(problem, evidence.base, other, fitted=True)


def _by_row(one: Fit) -> float:
    return one.total / one.rows


def _polished(evidence: Evidence, best: Fit) -> Fit:
    """From other sizes of the newest effect: abrupt effects have false minima."""
    effect = EFFECTS[best.hypothesis.ids[-1]]
    if not effect.abrupt or evidence.share(best) < WORTH_POLISH:
        return best
    if not evidence.settled(best) and not best.hypothesis.far:  # far numbers have no nominal ones
        own = next(
            i for i, c in enumerate(best.hypothesis.coordinates()) if c.term == len(best.hypothesis.terms) - 1
        )
        best = _from_sizes(evidence, best, nominal(best.hypothesis, best.theta), own, OTHER_SIZES)
    if evidence.problem.partial:
        return _by_other_laws(evidence, best)
    places = places_of(evidence, best)
    other = _by_other_laws(evidence, places.best)  # a law that is not right tells no width from another
    return other if other is not places.best else most_likely(evidence, places)


def _by_other_laws(evidence: Evidence, best: Fit) -> Fit:
    """`best`, or its newest effect by another author's law, where nothing else seems to be missing."""
    return best if evidence.share(best) < FORM_FROM else by_other_laws(evidence, best)


def _from_sizes(evidence: Evidence, best: Fit, theta: Array, index: int, factors: tuple[float, ...]) -> Fit:
    """The best of `best` and of fits from `theta` with its number `index` times each factor."""
    problem = evidence.problem.with_angles(best.angles)
    for factor in factors:
        other = theta.copy()
        other[index] += np.log(factor)
        best = min(best, promising(problem, best, best.hypothesis, evidence.base.starts, other), key=rank)
    return best
