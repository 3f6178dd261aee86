"""The way from recordings to a verdict."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import Point, point_at, with_better_starts
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._odds import Candidate
from hil.analysis.missing_effects._outcome import Outcome, Replay
from hil.analysis.missing_effects._phase import tracked
from hil.analysis.missing_effects._problem import Problem, problem_of
from hil.analysis.missing_effects._search import search
from hil.analysis.missing_effects._series import Series
from hil.analysis.missing_effects._share import Judged
from hil.analysis.missing_effects._simulations import INTERRUPTED, OUT_OF_TIME, Allowance, OutOfTimeError
from hil.analysis.missing_effects._verdict import as_far_as_known, judged
from hil.core.effects import EFFECTS
from hil.core.model import Model

Array = npt.NDArray[np.float64]


def explain_gap(
    model: Model,
    series: Sequence[Series],
    holdout: Sequence[Series] = (),
    *,
    noise: Mapping[str, float] | None = None,
    at_most_s: float = math.inf,
    show: Callable[[str], None] = lambda text: None,
) -> Outcome:
    """Say which effects a model lacks to explain recordings (`series_of`), and how sure that is.

    Args:
        model: a chain; its numbers are a prior, so that any base of the same kind gets the same answer. Or
            transfer functions, to which only effects of torque path and sensors can be added.
        holdout: recordings that no fit sees: what is left is judged by them.
        noise: standard deviation of a sample that a channel's sensor is known to have, by channel.
        at_most_s: processor time of the search, s.
        show: called with what is being fitted.

    An interrupt (KeyboardInterrupt) ends the search as its time does; before anything is known, and while
    it is stated, it is raised.
    """
    began = time.perf_counter()
    levels = proven_noise(series, noise or {})
    problem = problem_of(model, series, levels)
    problem = replace(problem, allowance=Allowance(at_most_s))
    done = Candidates(problem)
    unfinished = _searched(done, show)
    problem.allowance.lift()
    unseen = problem
    if holdout:
        unseen = problem_of(model, holdout, levels, done.problem.spectrum)
    show("judging")
    shown = _Shown(problem, unseen, done)
    fitted = tuple(Replay(one.as_sampled or one) for one in problem.series)
    held_out = tuple(Replay(one.as_sampled or one) for one in unseen.series) if holdout else ()
    of = Judged(model, done, shown.left, fitted, held_out)
    found = as_far_as_known(of, unfinished) if unfinished else judged(of)
    return replace(found, seconds=time.perf_counter() - began)


def _searched(done: Candidates, show: Callable[[str], None]) -> str:
    """Search, and say why that ended before it was through, if it did."""
    try:
        search(done, show)
    except KeyboardInterrupt:
        if not done.found:
            raise
        return INTERRUPTED
    except OutOfTimeError:
        done.problem.allowance.lift()
        if not done.found:  # nothing was fitted yet: the model as it came
            base = done.problem.as_it_came
            started = with_better_starts(done.problem, point_at(done.problem, base))
            done.found[()] = done.judged(started)
            done.go_on_from(done.found[()])
        return OUT_OF_TIME
    return ""


@dataclass
class _Shown:
    """What hypotheses leave of the recordings that are fitted and of those that are not."""

    problem: Problem
    unseen: Problem
    done: Candidates
    known: dict[int, tuple[Candidate, Array]] = field(default_factory=dict)

    def point(self, problem: Problem, hypothesis: Hypothesis) -> Point:
        """A hypothesis on recordings of a problem, with the starts that suit them best."""
        for one in self.done.found.values():
            if problem is self.problem and one.point.hypothesis is hypothesis:
                return one.point
        return with_better_starts(problem, point_at(problem, hypothesis))

    def errors(self, problem: Problem, hypothesis: Hypothesis) -> tuple[Array, ...]:
        """Of each recording of a problem; of one that no fit sees with angles as a ripple tells them."""
        point = self.point(problem, hypothesis)
        if problem is self.problem or not any(EFFECTS[use.id].law.follows for use in hypothesis.terms):
            return point.errors
        turned, _ = tracked(problem, point)
        return with_better_starts(turned, point_at(turned, hypothesis, point.starts)).errors

    def left(self, candidate: Candidate) -> Array:
        """Mean square of errors in each channel over all recordings, (3,); NaN if not recorded.

        Recordings held out count along; alone, they would judge effects that they do not excite.
        """
        if id(candidate) not in self.known:
            self.known[id(candidate)] = candidate, self._left(candidate.point.hypothesis)
        return self.known[id(candidate)][1]

    def _left(self, hypothesis: Hypothesis) -> Array:
        both = (self.problem,) if self.unseen is self.problem else (self.problem, self.unseen)
        whole = replace(self.problem, series=tuple(s for one in both for s in one.series))
        return whole.mean_square([e for one in both for e in self.errors(one, hypothesis)])
