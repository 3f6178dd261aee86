"""Optional numbers of effects, and choices between forms of their laws: opened where they pay, closed again
where others made them needless.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, cheapest, fit, started_from
from hil.analysis.diagnosis.fit.least_squares import Hopeless
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.evidence import Evidence, rank
from hil.analysis.diagnosis.search.hidden_speeds import with_hidden_speeds
from hil.analysis.diagnosis.search.thresholds import (
    FORM_HOPELESS,
    FORM_ROUNDS,
    LEAST_EVIDENCE,
    LITTLE_GAINED,
    OPTIONAL_LEAVES,
    UNKNOWN_SIGMAS,
)
from hil.core.effects import EFFECTS, Parameter
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


def refined(problem: Problem, evidence: Evidence, best: Fit) -> Fit:
    """Optional numbers of the effects, and choices between forms of their laws, where they pay."""
    for index, term in enumerate(best.hypothesis.terms):
        for parameter in EFFECTS[term.id].parameters:
            of_form = bool(parameter.choices or parameter.beside)
            if of_form and evidence.closed(best):  # nothing that another form could explain
                continue
            tried = [_chosen_as(problem, best, index, parameter, v) for v in _others(best, index, parameter)]
            if parameter.opens and parameter.name not in best.hypothesis.open:
                tried.append(_opened(problem, best, index, parameter))
            for one in tried:
                if evidence.left(one) < OPTIONAL_LEAVES * evidence.left(best) and (
                    evidence.between(best, one) > LEAST_EVIDENCE
                ):
                    best = one
    return _stated(problem, best)


def _stated(problem: Problem, best: Fit) -> Fit:
    """Without the optional numbers that others made needless: as near to their defaults as their errors."""
    for c, value, error in zip(best.hypothesis.coordinates(), best.theta, best.white_errors, strict=True):
        if c.term < 0 or c.scale != "linear" or c.name not in best.hypothesis.open:
            continue
        parameter = EFFECTS[best.hypothesis.terms[c.term].id].parameter(c.name)
        if abs(value - parameter.default) > UNKNOWN_SIGMAS * error:
            continue
        fewer = _closed(best.hypothesis, c.term, parameter)
        one = fit(problem, fewer, best.starts, started_from(best, fewer), enough=little(problem, best))
        best = min(best, one, key=rank)
    return best


def _closed(hypothesis: Hypothesis, index: int, parameter: Parameter) -> Hypothesis:
    """Without that optional number of effect number `index`, and those that mean nothing without it."""
    needless = [parameter]
    needless += [p for p in EFFECTS[hypothesis.terms[index].id].parameters if p.beside == parameter.name]
    for one in needless:
        hypothesis = _with_value(hypothesis, index, one.name, one.default)
    names = {one.name for one in needless}
    return replace(hypothesis, open=tuple(name for name in hypothesis.open if name not in names))


def _others(best: Fit, index: int, parameter: Parameter) -> list[float]:
    """Values of a number that is chosen which the effect number `index` does not have yet."""
    if parameter.beside and parameter.beside not in best.hypothesis.open:
        return []
    return [v for v in parameter.choices if v != best.hypothesis.terms[index].values[parameter.name]]


def _chosen_as(problem: Problem, best: Fit, index: int, parameter: Parameter, value: float) -> Fit:
    """`best` with another choice."""
    hypothesis = _with_value(best.hypothesis, index, parameter.name, value)
    return promising(problem, best, hypothesis, best.starts, started_from(best, hypothesis))


def _with_value(hypothesis: Hypothesis, index: int, name: str, value: float) -> Hypothesis:
    """The hypothesis with another value of its effect number `index`."""
    terms = list(hypothesis.terms)
    terms[index] = EffectUse(terms[index].id, {**terms[index].values, name: value})
    return replace(hypothesis, terms=tuple(terms))


def _opened(problem: Problem, best: Fit, index: int, parameter: Parameter) -> Fit:
    """`best` with an optional number more, and the one that it needs, from the most promising values."""
    effect = EFFECTS[best.hypothesis.terms[index].id]
    names = [n for n in (parameter.beside, parameter.name) if n and n not in best.hypothesis.open]
    hypothesis = replace(best.hypothesis, open=(*best.hypothesis.open, *names))
    theta = started_from(best, hypothesis)
    own = {c.name: i for i, c in enumerate(hypothesis.coordinates()) if c.term == index}
    tried = []
    for values in product(*(effect.parameter(name).opens for name in names)):
        other = theta.copy()
        for name, value in zip(names, values, strict=True):
            other[own[name]] = value if effect.parameter(name).typical is not None else np.log(value)
        tried.append(other)
    first = cheapest(problem, hypothesis, tried, best.starts)
    starts = with_hidden_speeds(problem, hypothesis, first, best.starts)
    return promising(problem, best, hypothesis, starts, first)


def promising(problem: Problem, best: Fit, hypothesis: Hypothesis, starts: list[Array], theta: Array) -> Fit:
    """A fit from there that may be better than `best`; given up after a few rounds where it is not near."""
    hopeless = Hopeless(FORM_ROUNDS, FORM_HOPELESS * best.total)
    return fit(problem, hypothesis, starts, theta, enough=little(problem, best), hopeless=hopeless)


def little(problem: Problem, one: Fit) -> float:
    """A step that gains less in the sum of squared errors says nothing of one fit against another."""
    return max(1.0, LITTLE_GAINED * (one.total - problem.rows))
