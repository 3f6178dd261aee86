"""How sure a name is: what the best rival leaves, and how much of the gap the named effects close."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hil.analysis.diagnosis.fit.coordinates import key_of
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.search import Found
from hil.analysis.diagnosis.tell.result import Alternative
from hil.analysis.diagnosis.tell.separating import plan_file, plan_within_recordings, worth_a_plan
from hil.analysis.diagnosis.tell.thresholds import (
    CHANNEL_NOISES,
    CLOSED_FAIRLY,
    CLOSED_WELL,
    CONFIDENCE_FLOOR,
    FAIRLY_SURE,
    HALF_MARGIN,
    HALF_OPEN,
    HALVED,
    LEFT_NOISELESS,
    LESS_SURE,
    NOISELESS,
    OPEN_CONFIDENCE,
    STANDSTILL_NOISES,
)
from hil.core.effects import EFFECTS, Effect
from hil.core.model import EffectUse


def _odds(margin: float) -> float:
    """Weight of a rival whose hypothesis is poorer by `margin` of evidence, 1 for an equal one."""
    return float(np.exp(-np.clip(margin, 0.0, 400.0) / (HALF_MARGIN / 2.2)))


def rivals(found: Found, index: int) -> list[tuple[Fit, float]]:
    """Fits of as many effects without effect `index`, with the evidence against each, closest first."""
    best = found.best
    key = best.hypothesis.keys[index]
    kept: dict[frozenset[tuple[str, str]], tuple[Fit, float]] = {}
    for step in found.steps:
        for one in step.fits:
            if _comparable(one, best, key) and key not in one.hypothesis.keys:
                margin = found.evidence.between(one, best)
                kept.setdefault(frozenset(one.hypothesis.keys), (one, margin))
    return sorted(kept.values(), key=lambda pair: pair[1])


def _comparable(one: Fit, best: Fit, key: tuple[str, str]) -> bool:
    """Whether two fits have as many effects. Where all parameters are free none of them is an effect."""
    if one.hypothesis.far == best.hypothesis.far:
        return len(one.hypothesis.terms) == len(best.hypothesis.terms)
    mine, others = (sum(id_ != "parameter_mismatch" for id_ in f.hypothesis.ids) for f in (best, one))
    return mine == others and key[0] != "parameter_mismatch"


def drop_of(found: Found, index: int) -> float:
    """What effect number `index` takes off the squared error, in noise variances: its evidence."""
    best = found.best
    key = best.hypothesis.keys[index]
    fewer = [
        one.total
        for step in found.steps
        for one in step.fits
        if one.hypothesis.far == best.hypothesis.far
        and key not in one.hypothesis.keys
        and set(one.hypothesis.keys) < set(best.hypothesis.keys)
    ]
    return min([found.base.total, *fewer]) - best.total


def confidence_of(found: Found, index: int) -> float:
    """Chance that effect number `index` of the accepted hypothesis is rightly named."""
    weight = sum(_odds(margin) for _, margin in rivals(found, index))
    sure = 1.0 / (1.0 + weight)
    worst = found.evidence.worst(found.best)
    closing = (
        1.0 - CONFIDENCE_FLOOR if worst < CLOSED_WELL else FAIRLY_SURE if worst < CLOSED_FAIRLY else LESS_SURE
    )
    return sure * (min(closing, HALF_OPEN) if _half_open(found) else closing)


def _half_open(found: Found) -> bool:
    """Whether a channel keeps half of its gap, a third where formulas differ, though all together close."""
    base = found.given or found.base
    most = LEFT_NOISELESS if float(np.max(found.evidence.gaps(base))) > NOISELESS else HALVED
    before, after = (np.sqrt(found.evidence.physics(f)) for f in (base, found.best))
    return bool(np.any((after > most * before) & (found.evidence.gaps(found.best) > CHANNEL_NOISES)))


def alternatives_of(found: Found, verdict: str) -> tuple[Alternative, ...]:
    """Other names worth knowing, with the experiment that would tell them apart."""
    kept: dict[tuple[str, str], Alternative] = {}
    for mine, one, confidence in _others(found, verdict):
        others = [u for u, k in _uses(one) if k not in mine.hypothesis.keys]
        if mine is one:
            others = [u for u, _ in _uses(one)]
        if not others or key_of(others[0]) in kept:
            continue
        use = others[0]
        problem = found.evidence.problem
        text, plan = _experiment(EFFECTS[use.id], problem), None
        if mine is not one and worth_a_plan(confidence, problem.traces):
            text, plan = plan_within_recordings(
                mine.hypothesis.model(mine.theta),
                one.hypothesis.model(one.theta),
                problem.noise,
                problem.traces,
                problem.gear_ratio,
                (mine.hypothesis.ids[-1], use.id),
            )
        name = plan_file(use) if plan else None
        kept[key_of(use)] = Alternative(use, confidence, text, name, plan)
    return tuple(sorted(kept.values(), key=lambda a: -a.confidence)[:5])


def _experiment(effect: Effect, problem: Problem) -> str:
    """Which experiment shows an effect, and that these recordings hide it where they do."""
    if effect.needs_reversals and turns_one_way(problem):
        return f"{effect.shown_by} In these recordings the axle always turns one way, which hides it."
    return effect.shown_by


def turns_one_way(problem: Problem) -> bool:
    """Whether the axle turns to one side alone, beyond noise; False where a recording has no speed."""
    ways: set[int] = set()
    for trace in problem.traces:
        column = 0 if trace.has[0] else 1
        if not trace.has[column]:
            return False
        level = STANDSTILL_NOISES * float(problem.noise[column]) / np.sqrt(trace.block)
        ways |= {sign for sign in (-1, 1) if np.any(sign * trace.measured[:, column] > level)}
    return len(ways) == 1


def _others(found: Found, verdict: str) -> list[tuple[Fit, Fit, float]]:
    """(what it is held against, rival, its confidence)."""
    if verdict == "none":
        return []
    if verdict == "named":
        pairs = []
        for index in range(len(found.best.hypothesis.terms)):
            against = rivals(found, index)
            total = 1.0 + sum(_odds(margin) for _, margin in against)
            pairs += [(found.best, one, _odds(margin) / total) for one, margin in against]
        return pairs
    if not found.steps or not found.steps[0].fits:
        return []
    first, *rest = found.steps[0].fits
    second = rest[0] if rest else first
    return [(second, first, OPEN_CONFIDENCE), (first, second, OPEN_CONFIDENCE)]


def _uses(one: Fit) -> list[tuple[EffectUse, tuple[str, str]]]:
    uses = one.hypothesis.model(one.theta).effects[len(one.hypothesis.base.effects) :]
    return [(use, key_of(use)) for use in uses]


@dataclass(frozen=True)
class Sure:
    """How sure the names are, by the fits that the search compared: whatever is fitted anew afterwards.

    Of each effect its confidence and what it takes off the squared error; other names for the gap.
    """

    confidences: tuple[float, ...]
    drops: tuple[float, ...]
    alternatives: tuple[Alternative, ...]

    @classmethod
    def of(cls, found: Found) -> Sure:
        """Of the accepted hypothesis."""
        each = range(len(found.best.hypothesis.terms))
        return cls(
            tuple(confidence_of(found, index) for index in each),
            tuple(drop_of(found, index) for index in each),
            alternatives_of(found, "named"),
        )
