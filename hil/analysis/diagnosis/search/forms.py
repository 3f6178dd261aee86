"""Laws of other authors, tried where an effect, fitted in every other way, leaves more than noise.

Not before: a law with more freedom makes up for a width that is not right yet, and then keeps it wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import product

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Coordinate, Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, cheapest, fit, fitted_on, started_from
from hil.analysis.diagnosis.fit.least_squares import Hopeless
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.evidence import Evidence, rank
from hil.analysis.diagnosis.search.places import placed, width_of, with_likely_width
from hil.analysis.diagnosis.search.race import nominal
from hil.analysis.diagnosis.search.thresholds import (
    AS_GOOD,
    FORM_FIRST,
    FORM_HOPE,
    FORM_HOPELESS,
    FORM_LEAVES,
    FORM_ROUNDS,
    LEAST_EVIDENCE,
    PLACE_ROUNDS,
)
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


def by_other_laws(evidence: Evidence, best: Fit) -> Fit:
    """`best`, or its newest effect by the law of another author that leaves clearly less."""
    if not EFFECTS[best.hypothesis.ids[-1]].forms or evidence.settled(best):
        return best
    first = _by_likeliest_law_to_the_end(evidence, best, best)
    if not evidence.settled(first) and rank(first) < FORM_HOPELESS * rank(best):
        # numbers of the base that a wrong law has bent lead no law back
        plain = replace(best, theta=nominal(best.hypothesis, best.theta))
        first = min(first, _by_likeliest_law_to_the_end(evidence, plain, best), key=rank)
    less = evidence.left(first) < FORM_LEAVES * evidence.left(best)
    if not less or evidence.between(best, first) < LEAST_EVIDENCE:
        return best
    return first if evidence.problem.partial else placed(evidence, first)


def _by_likeliest_law_to_the_end(evidence: Evidence, one: Fit, best: Fit) -> Fit:
    """Started from `one`; not to its end where it leaves clearly more than `best` after a few rounds."""
    problem = evidence.problem.with_angles(one.angles)
    first = by_likeliest_law(evidence, one)
    if rank(first) > FORM_HOPE * rank(best):
        return first
    return _widened(problem, fitted_on(problem, first))


def by_likeliest_law(evidence: Evidence, one: Fit) -> Fit:
    """`one` with its newest effect by that law of another author that leaves least after a few rounds."""
    forms = EFFECTS[one.hypothesis.ids[-1]].forms
    return min((_by(evidence, one, form) for form in forms), key=rank)


def _by(evidence: Evidence, best: Fit, form: Mapping[str, tuple[float, ...]]) -> Fit:
    """`best` with the law `form`, from the most promising of its values and with the width that suits it.

    It is fitted for a few rounds: these tell one law from another.
    """
    problem = evidence.problem.with_angles(best.angles)
    hypothesis = _written(best.hypothesis, form)
    theta = started_from(best, hypothesis)
    own = {c.name: (i, c) for i, c in enumerate(hypothesis.coordinates()) if _is_newest(hypothesis, c)}
    moved = {own[name]: values for name, values in form.items() if name in own}
    tried = []
    for values in product(*moved.values()):
        other = theta.copy()
        for (index, c), value in zip(moved, values, strict=True):
            other[index] = value if c.scale == "linear" else np.log(value)
        tried.append(other)
    first = cheapest(problem, hypothesis, tried, best.starts)
    if (width := width_of(hypothesis)) is not None:
        likely = with_likely_width(problem, hypothesis, first, best.starts, width)
        first = cheapest(problem, hypothesis, [first, likely], best.starts)
    hopeless = Hopeless(FORM_FIRST, FORM_HOPELESS * best.total)
    return fit(problem, hypothesis, best.starts, first, rounds=FORM_ROUNDS, hopeless=hopeless)


def _widened(problem: Problem, one: Fit) -> Fit:
    """`one`, or what it comes to from the width that is likeliest now that its damping is known."""
    width = width_of(one.hypothesis)
    for _ in range(PLACE_ROUNDS if width is not None else 0):
        assert width is not None
        theta = with_likely_width(problem, one.hypothesis, one.theta, one.starts, width)
        other = fit(problem, one.hypothesis, one.starts, theta)
        better, one = rank(other) < (1.0 - AS_GOOD) * rank(one), min(one, other, key=rank)
        if not better:
            break
    return one


def _written(hypothesis: Hypothesis, form: Mapping[str, tuple[float, ...]]) -> Hypothesis:
    """`hypothesis`, its newest effect by `form`, whose numbers alone are open of the optional ones."""
    newest = hypothesis.terms[-1]
    effect = EFFECTS[newest.id]
    given = {name: values[0] for name, values in form.items()}
    moved = {name for name in form if effect.parameter(name).fitted}
    plain = {p.name: p.default for p in effect.parameters if p.optional}
    terms = (*hypothesis.terms[:-1], EffectUse(newest.id, {**newest.values, **plain, **given}))
    still = {*hypothesis.open} - {*plain}
    return replace(hypothesis, terms=terms, open=tuple(sorted(still | moved)))


def _is_newest(hypothesis: Hypothesis, c: Coordinate) -> bool:
    return c.term == len(hypothesis.terms) - 1
