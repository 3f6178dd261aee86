"""How sure a name is: what the best rival leaves, and how much of the gap the named effects close."""

from __future__ import annotations

import numpy as np

from hil.analysis.diagnosis._fit import Fit
from hil.analysis.diagnosis._problem import Problem
from hil.analysis.diagnosis._result import Alternative
from hil.analysis.diagnosis._search import Found, evidence
from hil.analysis.diagnosis._separating import separating_plan
from hil.core.effects import EFFECTS

_HALF_MARGIN = 12.0  # evidence over a rival at which it is about one in ten
_FLOOR = 0.005
_WORTH_A_PLAN = 0.02


def _odds(margin: float) -> float:
    """Weight of a rival whose hypothesis is poorer by `margin` of evidence, 1 for an equal one."""
    return float(np.exp(-np.clip(margin, 0.0, 400.0) / (_HALF_MARGIN / 2.2)))


def rivals(problem: Problem, found: Found, index: int) -> list[tuple[Fit, float]]:
    """Fits of other effects in place of effect `index`, with the evidence against each."""
    if index >= len(found.steps):
        return []
    best = found.best
    named = set(best.hypothesis.keys)
    step = found.steps[index]
    same_size = [f for f in step.fits if f.hypothesis.keys[-1] not in named]
    reference = next((f for f in step.fits if f.hypothesis.keys[-1] in named), None)
    if reference is None:
        return []
    return [(f, evidence(problem, f, reference)) for f in same_size]


def confidence_of(problem: Problem, found: Found, index: int) -> float:
    """Chance that effect number `index` of the accepted hypothesis is rightly named."""
    weight = sum(_odds(margin) for _, margin in rivals(problem, found, index))
    sure = 1.0 / (1.0 + weight)
    left = float(np.sqrt(max(found.best.cost / problem.rows, 1.0)))
    closing = 1.0 - _FLOOR if left < 1.1 else 0.97 if left < 1.6 else 0.9
    return sure * closing


def alternatives_of(problem: Problem, found: Found, verdict: str) -> tuple[Alternative, ...]:
    """Other names worth knowing, with the experiment that would tell them apart."""
    kept = []
    for index in range(len(found.best.hypothesis.terms) if verdict == "named" else len(found.steps[:1])):
        pairs = (
            rivals(problem, found, index)
            if verdict == "named"
            else [(f, 0.0) for f in found.steps[0].fits[:2]]
        )
        total = 1.0 + sum(_odds(m) for _, m in pairs)
        for fit, margin in pairs:
            confidence = _odds(margin) / total if verdict == "named" else 0.05
            use = fit.hypothesis.model(fit.theta).effects[-1]
            text, plan = EFFECTS[use.id].shown_by, None
            if confidence > _WORTH_A_PLAN:
                rival = fit.hypothesis.model(fit.theta)
                mine = found.steps[index].fits[0]
                text, plan = separating_plan(
                    mine.hypothesis.model(mine.theta),
                    rival,
                    problem.noise,
                    max(float(np.max(np.abs(t.torque))) for t in problem.traces),
                    (mine.hypothesis.ids[-1], use.id),
                )
            name = f"separate_{use.id}.yaml" if plan else None
            kept.append(Alternative(use, confidence, text, name, plan))
    return tuple(sorted(kept, key=lambda a: -a.confidence)[:5])
