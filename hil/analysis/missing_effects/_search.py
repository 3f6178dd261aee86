"""The one search: numbers alone, then the best name joins and needless ones leave, while the score grows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from hil.analysis.missing_effects._fit import Point, begun, fit, linearised
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._odds import Candidate, penalty_of
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import best_by_name, may_join, promises
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

_SHORT = 2  # rounds that tell which start or size is worth more of them
_TRIED = 6  # names that are fitted at each step, the most promising ones
_SIZES = 2  # from which each of them starts
_CARED_FOR = 2  # of these are fitted to their end
_ROUNDS = 6
_SETTLED = 0.1  # growth of log likelihood between rounds that ends them
_MOST_NAMES = 4


@dataclass
class Search:
    """All hypotheses that were fitted, best of each set of names, and the problem that they are weighed by."""

    problem: Problem
    found: dict[tuple[str, ...], Candidate] = field(default_factory=dict)

    @property
    def best(self) -> Candidate:
        """The hypothesis with the highest score."""
        return max(self.found.values(), key=lambda one: one.score)

    def fitted(self, hypothesis: Hypothesis, near: Candidate | None, rounds: int = _ROUNDS) -> Candidate:
        """Fit a hypothesis, weighed by the spectrum that it leaves itself, and remember it if it is the best of its names."""
        point = begun(self.problem, hypothesis, near.point.starts if near else None)
        best = before = self._candidate(point)
        problem = self.problem
        for number in range(rounds):
            # slow misfit would trade a dead time for anything: it is known once errors are weighed by their colour
            point = fit(problem, point, frozenset() if number else frozenset({"torque_delay"}))
            after = self._candidate(point)
            best = max(best, after, key=lambda one: one.score)
            if abs(after.score - before.score) < _SETTLED:
                break
            before = after
            problem = self.problem.weighed_by(point.powers(problem).spectrum(problem.noise))
        key = tuple(sorted(best.names))
        self.found[key] = max(self.found.get(key, best), best, key=lambda one: one.score)
        return best

    def _candidate(self, point: Point) -> Candidate:
        powers = point.powers(self.problem)
        hypothesis = point.hypothesis
        known = sum(may_join(effect, Hypothesis(hypothesis.base, {})) for effect in EFFECTS.values())
        values = 2.0 * float(np.sum(powers.bins))
        penalty = penalty_of(
            len(hypothesis.terms), len(hypothesis.coordinates(self.problem.scales)), known, values
        )
        return Candidate(point, powers.log_likelihood(self.problem.noise), penalty)


def search(problem: Problem, starts: Sequence[Hypothesis], show: Callable[[str], None]) -> Search:
    """Fit the numbers alone from each of `starts`, then grow and prune sets of effects."""
    done = Search(problem)
    show("numbers alone")
    begun = [done.fitted(one, None, _SHORT) for one in starts]
    best = max([done.fitted(one.point.hypothesis, one) for one in begun], key=lambda one: one.score)
    others = [one.point.hypothesis for one in begun] + list(starts[1:])
    while len(best.names) < _MOST_NAMES:
        done.problem = problem.weighed_by(best.point.powers(problem).spectrum(problem.noise))
        grown = _grown(done, best, [] if best.names else others, show)
        if grown is None or grown.score <= best.score:
            break
        best = _pruned(done, grown)
    return done


def _grown(
    done: Search, best: Candidate, others: Sequence[Hypothesis], show: Callable[[str], None]
) -> Candidate | None:
    """The best hypothesis with one more effect; None where no effect promises more than it costs.

    Args:
        others: numbers to start from beside the best ones.
    """
    cost = _cost_of_a_name(done, best)
    promised = [one for one in promises(done.problem, linearised(done.problem, best.point)) if one.drop > cost]
    tried: list[Candidate] = []
    for sizes in best_by_name(promised, _SIZES)[:_TRIED]:
        show(" + ".join([*best.names, sizes[0].label]))
        tried += [
            done.fitted(start.with_term(one.use), best if start is best.point.hypothesis else None, _SHORT)
            for one in sizes
            for start in (best.point.hypothesis, *others)
        ]
    tried.sort(key=lambda one: -one.score)
    ended: list[Candidate] = []
    for one in tried:
        if one.names not in [other.names for other in ended]:
            ended.append(_opened(done, done.fitted(one.point.hypothesis, one), show))
        if len(ended) == _CARED_FOR:
            break
    return max(ended, key=lambda one: one.score, default=None)


def _cost_of_a_name(done: Search, best: Candidate) -> float:
    values = 2.0 * float(np.sum(best.point.powers(done.problem).bins))
    return penalty_of(1, 1, len(EFFECTS), values)


def _opened(done: Search, best: Candidate, show: Callable[[str], None]) -> Candidate:
    """With those optional numbers of its last effect that earn their place."""
    index = len(best.names) - 1
    for parameter in EFFECTS[best.point.hypothesis.terms[index].id].parameters:
        hypothesis = best.point.hypothesis
        opened = hypothesis.opened[index]
        if not parameter.opens or (parameter.beside and parameter.beside not in opened):
            continue
        show(f"{best.names[index]}: {parameter.name}")
        tried = []
        for value in parameter.opens:
            use = hypothesis.terms[index]
            wider = hypothesis.without(index).with_term(
                EffectUse(use.id, {**use.values, parameter.name: value}), opened | {parameter.name}
            )
            tried.append(done.fitted(wider, best, _SHORT))
        likeliest = max(tried, key=lambda one: one.score)
        if likeliest.score > best.score:
            best = done.fitted(likeliest.point.hypothesis, likeliest)
    return best


def _pruned(done: Search, best: Candidate) -> Candidate:
    """Without those effects that later ones made needless."""
    for index in reversed(range(len(best.names) - 1)):
        fewer = done.fitted(best.point.hypothesis.without(index), best)
        if fewer.score >= best.score:
            return _pruned(done, fewer)
    return best
