"""From scores to names: fits of the promising effects, one, two, three at a time, until the gap is closed.

A hypothesis with more names must earn them: by evidence (the drop of the squared error against the noise,
deflated by the colour of what is left), by size (the share of the remaining gap that it closes), and by
need (without any one of them, all others refitted, the gap opens again).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit, started_from
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.alignment import with_base_angles
from hil.analysis.diagnosis.search.evidence import Evidence, doubted, rank
from hil.analysis.diagnosis.search.growth import finish, grow
from hil.analysis.diagnosis.search.quantization import rounding_of
from hil.analysis.diagnosis.search.race import Step
from hil.analysis.diagnosis.search.screen import Score
from hil.analysis.diagnosis.search.thresholds import (
    ALONE,
    FAR,
    HALF_AS_GOOD,
    LEAST_EVIDENCE,
    LEAST_SHARE,
    LEAST_SHARE_OF_REST,
    LEAST_SO_FAR,
    MOST_EFFECTS,
    NEARLY,
    OUT_OF_RACE,
    PARENTS,
    RACE_SLACK,
    RIVAL,
)
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


@dataclass
class Found:
    """The base model at its best, the accepted hypothesis, and everything that was considered."""

    base: Fit
    best: Fit
    evidence: Evidence
    steps: list[Step] = field(default_factory=list)
    #: Hypotheses that the next step grows from, best first, and how many effects they have.
    frontier: list[Fit] = field(default_factory=list)
    effects: int = 0
    #: The model as it was given, where the search began from another one.
    given: Fit | None = None
    #: Other numbers of the base model alone, where they were looked for and not taken.
    numbers: Fit | None = None
    #: Errors count everywhere: what was left out for an effect that was not found is not left out again.
    everywhere: bool = False
    #: Fits whose effects were found to be all needed, or that this led to.
    needed: Fit | None = None

    @property
    def clear(self) -> bool:
        """Whether the accepted effect stands alone beside free numbers, though its law is not quite right."""
        return self.best.hypothesis.far and stands_alone(self.evidence, self.base, self.best, self.frontier)

    @property
    def settled(self) -> bool:
        """Whether no further effect is missing."""
        return self.evidence.settled(self.best)


def search(
    problem: Problem,
    base: Hypothesis,
    show: Callable[[str], None],
    rounded: Sequence[EffectUse] = (),
    known: list[Found] | None = None,
) -> Found:
    """Find the effects that the base model lacks: the fewest that close the gap.

    Args:
        known: gets the search as it begins: what is known of it should it be interrupted.
    """
    show("fitting the base model")
    found = begin_search(*with_base_angles(problem, fit(problem, base)), rounded)
    if known is not None:
        known.append(found)
    return finished(found, show)


def begin_search(problem: Problem, base: Fit, rounded: Sequence[EffectUse] = ()) -> Found:
    """A search that has looked for nothing yet."""
    rounding = rounding_of(problem, list(rounded), base)
    return Found(base, base, Evidence(problem, base, rounding), frontier=[base])


def finished(found: Found, show: Callable[[str], None]) -> Found:
    """`found` searched to its end, needless effects dropped.

    What no model could predict with an effect does not go unjudged without it: then all is looked at anew.
    """
    while advanced(found, show):
        pass
    if found.needed is not found.best:
        found.needed = found.best = _needed(found.evidence, found.best)
    if not found.evidence.problem.partial or found.best.hypothesis.remembers_place:
        return found
    show("using all parts of the recordings")
    found.everywhere = True
    return finished(_begin_again(found, found.evidence.problem.judging_all()), show)


def so_far(known: Sequence[Found]) -> Found:
    """Of searches that were ended from outside the one that explains most, what it tried best first."""
    found = min(known, key=lambda one: one.evidence.left(one.best))
    for step in found.steps:
        step.fits.sort(key=rank)
    return found


def advanced(
    found: Found,
    show: Callable[[str], None],
    scores: list[Score] | None = None,
    beside: Sequence[Fit] = (),
) -> bool:
    """Look for one effect more; False where there is nothing more to look for.

    Args:
        scores: of a first effect, where these are known already.
        beside: other fits with a first effect, to be fitted on from where they are.
    """
    steps = raced(found, show, scores, beside)
    return bool(steps) and refined(found, steps, show)


def raced(
    found: Found,
    show: Callable[[str], None],
    scores: list[Score] | None = None,
    beside: Sequence[Fit] = (),
) -> list[Step]:
    """The first half of `advanced`: steps with the promising effects fitted roughly; none if there are none.

    The last one ends the race where alone one of its effects predicts the motion.
    """
    number = found.effects
    if number == MOST_EFFECTS or found.settled:
        return []
    parents = [
        f for f in found.frontier[: PARENTS[number]] if found.evidence.share(f) >= LEAST_SO_FAR[number]
    ]
    if not parents:
        return []
    if number:
        show(f"searching for effect {number + 1} beside {' or '.join(f.hypothesis.ids[-1] for f in parents)}")
    else:
        show(f"searching for effect 1 of at most {MOST_EFFECTS}")
    before: list[Step] = list(found.steps)
    steps: list[Step] = []
    rivals: list[Fit] = []
    for parent in parents:
        steps.append(Step(parent, [], []))
        found.steps = [*before, *steps]  # what is known by then if the search is ended from outside
        grow(found.evidence, steps[-1], scores, beside, rivals, everywhere=found.everywhere)
        if steps[-1].predicted:
            break
        rivals += steps[-1].fits
    return steps


def refined(found: Found, steps: list[Step], show: Callable[[str], None]) -> bool:
    """The second half: the best of the race fitted with care, and named if it earns that."""
    if steps[-1].predicted:
        return _advanced_where_predicted(found, steps[-1], show)
    number, before = found.effects, found.steps[: -len(steps)]
    for step in worth_care(found.evidence.problem, steps):
        finish(found.evidence, step, everywhere=found.everywhere)
        if step.predicted:
            return _advanced_where_predicted(found, step, show)
        if found.evidence.settled(step.fits[0]):
            break
    found.steps = before + sorted(steps, key=lambda s: min((rank(f) for f in s.fits), default=np.inf))
    led = found.frontier[0]
    found.frontier = frontier = _distinct([one for s in steps for one in s.fits])
    found.effects += 1
    if not frontier:
        return False
    alone = number == 0 and stands_alone(found.evidence, found.base, frontier[0], frontier)
    next_ = following(led, frontier)
    if alone or earned(found.evidence, found.best, next_):
        found.best = next_
        if found.evidence.share(found.best) > NEARLY:
            enough = RIVAL * found.evidence.left(found.best)
            found.frontier = [f for f in frontier if found.evidence.left(f) <= enough]
    return True


def worth_care(problem: Problem, steps: Sequence[Step]) -> list[Step]:
    """Steps whose best fit may still become the best of all, most promising first.

    Far from the noise that is each of them: friction explains little there without its optional numbers.
    """
    ranked = sorted((step for step in steps if step.fits), key=lambda step: rank(step.fits[0]))
    if not ranked or ranked[0].fits[0].total > FAR * problem.rows:
        return ranked
    floor = float(problem.rows)
    near = OUT_OF_RACE * (ranked[0].fits[0].total - floor) + RACE_SLACK
    return [step for step in ranked if step.fits[0].total - floor <= near]


def _advanced_where_predicted(found: Found, step: Step, show: Callable[[str], None]) -> bool:
    """`advanced` anew, where alone an effect of `step` predicts the motion."""
    assert step.predicted is not None
    problem, one = step.predicted
    show("using only parts that can be predicted")
    beside = [] if step.parent.hypothesis.terms else [one]
    return advanced(_begin_again(found, problem), show, beside=beside)


def _begin_again(found: Found, problem: Problem) -> Found:
    """The same search, nothing looked for yet, errors counting where `problem` says."""
    base = found.base
    found.base = found.best = fit(problem, base.hypothesis, base.starts, base.theta)
    found.evidence = Evidence(problem, found.base, found.evidence.rounding)
    found.steps, found.frontier, found.effects = [], [found.base], 0
    return found


def _distinct(fits: list[Fit]) -> list[Fit]:
    """Best first, the same set of effects once."""
    best: dict[frozenset[tuple[str, str]], Fit] = {}
    for one in sorted(fits, key=rank):
        best.setdefault(frozenset(one.hypothesis.keys), one)
    return list(best.values())


def following(led: Fit, frontier: Sequence[Fit]) -> Fit:
    """What may be named next: the first of `frontier`, best first.

    Where that is doubted, the first that keeps the names of `led`, which led before: where formulas differ,
    faults in sensors beside anything explain a little more, and say nothing against what led without them.
    """
    if not doubted(frontier[0]):
        return frontier[0]
    kept = set(led.hypothesis.keys)
    return next((one for one in frontier if kept <= set(one.hypothesis.keys)), frontier[0])


def earned(evidence: Evidence, poorer: Fit, richer: Fit) -> bool:
    """Whether `richer` earns its further names."""
    more = len(richer.hypothesis.terms) - len(poorer.hypothesis.terms)
    if evidence.between(poorer, richer) < LEAST_EVIDENCE * more:
        return False
    closed = 1.0 - evidence.left(richer) / max(evidence.left(poorer), 1e-12)
    return closed > (LEAST_SHARE_OF_REST if evidence.share(poorer) > NEARLY else LEAST_SHARE)


def stands_alone(evidence: Evidence, base: Fit, one: Fit, others: Sequence[Fit]) -> bool:
    """Whether one effect of many laws explains a good part of what free numbers leave, and no other does.

    Real friction and contact follow no law of a registry to the noise.
    """
    if not one.hypothesis.far or len(one.hypothesis.terms) != 1:
        return False
    if not EFFECTS[one.hypothesis.ids[0]].many_laws or evidence.between(base, one) < LEAST_EVIDENCE:
        return False
    share = evidence.share(one)
    rest = [evidence.share(f) for f in others if f.hypothesis.keys != one.hypothesis.keys]
    return share > ALONE and max(rest, default=0.0) < HALF_AS_GOOD * share


def _needed(evidence: Evidence, best: Fit) -> Fit:
    """`best`, or without an effect that the later ones made needless."""
    problem = evidence.problem.with_angles(best.angles)
    for index in range(len(best.hypothesis.terms) - 1):
        fewer = best.hypothesis.without(index)
        tried = fit(problem, fewer, best.starts, started_from(best, fewer))
        if evidence.closed(tried) or not earned(evidence, tried, best):
            return tried
    return best
