"""From which base model to search: the one that was given, or the same identified anew.

A model that is near explains with few names what is missing. One that comes from a catalogue is wrong in
most of its numbers, and no effect can make up for that: its parameters are identified first, and physics is
looked for from there. Few names go before many numbers: the given model is left only where it leads
nowhere.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.far import identified
from hil.analysis.diagnosis.fit.fit import Fit, fit, started_from
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.thresholds import TOLERANCE
from hil.analysis.diagnosis.search.alignment import with_base_angles
from hil.analysis.diagnosis.search.evidence import rank
from hil.analysis.diagnosis.search.probes import delay_is_free
from hil.analysis.diagnosis.search.race import Step, freed
from hil.analysis.diagnosis.search.screen import Score, screen
from hil.analysis.diagnosis.search.search import Found, advanced, begin_search, finished, raced, refined
from hil.analysis.diagnosis.search.thresholds import (
    COMES_NEAR,
    FAR,
    FAR_BETTER,
    FAR_MOVED,
    FAR_SHARE,
    FAR_SIGMAS,
    HOPELESS_GAP,
    HOPELESS_PROMISE,
    MOST_EFFECTS,
    NUMBERS_LEAVE,
)
from hil.core.model import EffectUse


def search_from_base(
    problem: Problem,
    base: Hypothesis,
    show: Callable[[str], None],
    rounded: Sequence[EffectUse] = (),
    known: list[Found] | None = None,
) -> Found:
    """The effects that the base model lacks, searched from its own numbers, or from those that fit.

    `base.hypothesis.far` of what is found says which.

    Args:
        known: gets every search as it begins: what is known of it should it be interrupted.
    """
    known = [] if known is None else known
    show("fitting the base model")
    near = begin_search(*with_base_angles(problem, fit(problem, base)), rounded)
    known.append(near)
    if near.settled:
        return near
    show("scoring effects")
    scores = screen(problem, near.base)
    numbers = _Numbers(near, rounded, known)
    if _hopeless(near, scores) and (found := numbers.alone(show)):
        return found
    if steps := raced(near, show, scores):
        if _far_from_noise(near, steps) and (found := numbers.alone(show)):
            return found
        refined(near, steps, show)
    if near.settled:
        return finished(near, show)
    far = numbers.far(show)
    near.numbers = far.base
    return _better(near, far, numbers.tried, show)


@dataclass
class _Numbers:
    """The base model identified anew, beside a search from the `near` one: once, and only where asked for."""

    near: Found
    rounded: Sequence[EffectUse]
    known: list[Found]
    tried: Found | None = None
    _far: Found | None = None

    def far(self, show: Callable[[str], None]) -> Found:
        """A search from the base model identified anew, nothing looked for yet."""
        if self._far is None:
            self._far = _identified(self.near, self.rounded, show)
            self.known.append(self._far)
        return self._far

    def alone(self, show: Callable[[str], None]) -> Found | None:
        """What is found from other numbers, if these alone explain most and nothing is missing then."""
        if self._far is not None or not _explains(self.far(show).base, self.near):
            return None
        self.tried = self.far(show)
        found = _plainer(finished(self.tried, show))
        self._far = _anew(self.tried)
        return found if found.settled else None


def _identified(near: Found, rounded: Sequence[EffectUse], show: Callable[[str], None]) -> Found:
    show("identifying the parameters of the base model again")
    problem, start = identified(near.evidence.problem, near.base.hypothesis)
    found = begin_search(problem, start, rounded)
    found.given = near.base
    return found


def _anew(found: Found) -> Found:
    """The same search, nothing looked for yet."""
    return Found(found.base, found.base, found.evidence, frontier=[found.base], given=found.given)


def _hopeless(near: Found, scores: Sequence[Score]) -> bool:
    """Whether no effect alone promises much of a large gap."""
    problem = near.evidence.problem
    gap = near.evidence.left(near.base) * problem.rows / max(problem.channels, 1)
    promised = max((score.gain for score in scores), default=0.0)
    return near.evidence.worst(near.base) > HOPELESS_GAP and promised < HOPELESS_PROMISE * gap


def _far_from_noise(near: Found, steps: Sequence[Step]) -> bool:
    """Whether what wins a race beside the given numbers is far from the noise."""
    best = min((rank(one) for step in steps for one in step.fits), default=np.inf)
    return not steps[-1].predicted and best > FAR * near.evidence.problem.rows


def _explains(start: Fit, near: Found) -> bool:
    """Whether other numbers alone explain most, and many of them had to change."""
    return is_far(start) and near.evidence.left(start) < NUMBERS_LEAVE * near.evidence.left(near.base)


def _better(near: Found, far: Found, tried: Found | None, show: Callable[[str], None]) -> Found:
    """What explains more of two searches, each as far as it is worth it; the near one where in doubt.

    Args:
        tried: the far one as it ended when nothing was known of effects beside the given numbers.
    """
    if not is_far(far.base):
        near = finished(near, show)
        if near.settled:
            return near
    if near.steps and not far.settled:
        show("searching for an effect with other parameters of the base model")
        numbers = {"parameter_mismatch"} | ({"dead_time"} if delay_is_free(far.base) else set())
        promising = [f for f in near.steps[0].fits if not numbers & {*f.hypothesis.ids}]
        if tried is None or _leads_elsewhere(tried, promising):
            advanced(far, show, beside=promising)
        else:
            far = tried
    if near.evidence.left(far.best) > FAR_BETTER * near.evidence.left(near.best):
        return finished(near, show)
    far = _plainer(finished(far, show))
    if far.settled or far.evidence.left(far.best) < FAR_BETTER * near.evidence.left(near.best):
        return far
    near = finished(near, show)
    clearer = near.evidence.left(near.best) < FAR_BETTER * far.evidence.left(far.best)
    return near if near.settled or clearer else far


def _leads_elsewhere(tried: Found, promising: Sequence[Fit]) -> bool:
    """Whether an effect that is `promising` comes near what the search that was `tried` began with."""
    if not tried.steps:
        return True
    first = tried.steps[0]
    enough = COMES_NEAR * min((rank(one) for one in first.fits), default=np.inf)
    return any(rank(freed(tried.evidence.problem, first.parent, one)) < enough for one in promising)


def moved(one: Fit, least: float = 0.0) -> list[str]:
    """Parameters of the base model that are off by more than their tolerance, `least` and their own error."""
    base = one.hypothesis.base
    return [
        c.name
        for c, value, error in zip(one.hypothesis.coordinates(), one.theta, one.white_errors, strict=True)
        if c.term < 0 and abs(value) > max(least, base.tolerance.get(c.name, TOLERANCE), FAR_SIGMAS * error)
    ]


def is_far(one: Fit) -> bool:
    """Whether the model as a whole was far off: not a number or two, but a good part of them."""
    free = sum(c.term < 0 for c in one.hypothesis.coordinates())
    return len(moved(one, FAR_MOVED)) >= FAR_SHARE * free


def _plainer(far: Found) -> Found:
    """What was found from far, stated from near where most numbers turn out to be right after all."""
    wrong = moved(far.best)
    hypothesis = far.best.hypothesis
    if is_far(far.best) or len(wrong) + len(hypothesis.terms) > MOST_EFFECTS:
        return far
    near = replace(hypothesis, terms=(*hypothesis.terms, *_stated(far.best, wrong)), far=False)
    problem = far.evidence.problem.with_angles(far.best.angles)
    nearby = fit(problem, near, far.best.starts, started_from(far.best, near))
    base = fit(problem, replace(near, terms=(), open=()))
    found = begin_search(problem, base)
    found.best, found.steps = nearby, far.steps
    found.evidence.rounding = far.evidence.rounding
    return found if found.settled else far


def _stated(far: Fit, wrong: Sequence[str]) -> list[EffectUse]:
    """Wrong numbers as effects of a model that is near: dead time that it lacks has a name of its own."""
    given, values = far.hypothesis.base.parameters, far.hypothesis.model(far.theta).parameters
    more = {name: values[name] - given[name] for name in wrong}
    return [
        EffectUse("dead_time", {"extra_delay_s": more[name]})
        if name == "torque_delay" and more[name] > 0.0 and "dead_time" not in far.hypothesis.ids
        else EffectUse("parameter_mismatch", {"parameter": name, "value": values[name]})
        for name in wrong
    ]
