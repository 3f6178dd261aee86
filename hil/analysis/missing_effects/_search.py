"""The one search: numbers alone, then the best name joins and the worst leaves, while the score grows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from hil.analysis.missing_effects._fit import Fitted, fit
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._odds import Candidate, penalty_of
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import best_by_name, may_join, promises
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

_TRIED = 6  # names that are fitted at each step, the most promising ones
_SIZES = 2  # from which each of them starts
_MOST_NAMES = 4
_COLOURINGS = 3  # fits of one hypothesis, each weighed by the spectrum that the one before left


@dataclass
class Search:
    """All hypotheses that were fitted, and the problem that they are weighed by."""

    problem: Problem
    pool: list[Candidate] = field(default_factory=list)

    @property
    def numbers_alone(self) -> Candidate:
        """The hypothesis without effects."""
        return self.pool[0]

    @property
    def best(self) -> Candidate:
        """The hypothesis with the highest score."""
        return max(self.pool, key=lambda one: one.score)

    def fitted(self, hypothesis: Hypothesis, near: Fitted | None = None) -> Candidate:
        """Fit a hypothesis to the maximum of its own likelihood and remember it."""
        problem, found = self.problem, None
        for _ in range(_COLOURINGS):
            start = found or near
            found = fit(problem, found.hypothesis if found else hypothesis, start.starts if start else None)
            spectrum = found.powers(problem).spectrum(problem.noise)
            settled = np.nanmax(np.abs(np.log(spectrum.variance / problem.spectrum.variance))) < 0.1
            problem = problem.weighed_by(spectrum)
            if settled:
                break
        assert found is not None
        candidate = self._candidate(found)
        self.pool.append(candidate)
        return candidate

    def _candidate(self, fitted: Fitted) -> Candidate:
        powers = fitted.powers(self.problem)
        hypothesis = fitted.hypothesis
        known = sum(may_join(effect, Hypothesis(hypothesis.base, {})) for effect in EFFECTS.values())
        values = 2.0 * float(np.sum(powers.bins))
        penalty = penalty_of(len(hypothesis.terms), len(fitted.coordinates), known, values)
        return Candidate(fitted, powers.log_likelihood(powers.spectrum(self.problem.noise)), penalty)


def search(problem: Problem, starts: Sequence[Hypothesis], show: Callable[[str], None]) -> Search:
    """Fit the numbers alone from each of `starts`, then grow and prune sets of effects."""
    done = Search(problem)
    show("numbers alone")
    best = max((done.fitted(one) for one in starts), key=lambda one: one.score)
    done.pool = [best]
    while len(best.names) < _MOST_NAMES:
        done.problem = problem.weighed_by(best.fitted.powers(problem).spectrum(problem.noise))
        grown = _grown(done, best, show)
        if grown is None or grown.score <= best.score:
            break
        best = _pruned(done, _opened(done, grown, show))
    return done


def _grown(done: Search, best: Candidate, show: Callable[[str], None]) -> Candidate | None:
    """The best hypothesis with one more effect."""
    weighed = fit(done.problem, best.fitted.hypothesis, best.fitted.starts, evaluations=3)
    tried = []
    for sizes in best_by_name(promises(done.problem, weighed), _SIZES)[:_TRIED]:
        show(" + ".join([*best.names, sizes[0].label]))
        for one in sizes:
            hypothesis = best.fitted.hypothesis.with_term(one.use)
            tried.append(done.fitted(hypothesis, best.fitted))
    return max(tried, key=lambda one: one.score, default=None)


def _opened(done: Search, best: Candidate, show: Callable[[str], None]) -> Candidate:
    """With those optional numbers of its last effect that earn their place."""
    index = len(best.names) - 1
    for parameter in EFFECTS[best.fitted.hypothesis.terms[index].id].parameters:
        hypothesis = best.fitted.hypothesis
        opened = hypothesis.opened[index]
        if not parameter.opens or (parameter.beside and parameter.beside not in opened):
            continue
        show(f"{best.names[index]}: {parameter.name}")
        for value in parameter.opens:
            use = hypothesis.terms[index]
            wider = hypothesis.without(index).with_term(
                EffectUse(use.id, {**use.values, parameter.name: value}), opened | {parameter.name}
            )
            tried = done.fitted(wider, best.fitted)
            best = max(best, tried, key=lambda one: one.score)
    return best


def _pruned(done: Search, best: Candidate) -> Candidate:
    """Without those effects that later ones made needless."""
    for index in reversed(range(len(best.names) - 1)):
        fewer = done.fitted(best.fitted.hypothesis.without(index), best.fitted)
        if fewer.score >= best.score:
            return _pruned(done, fewer)
    return best
