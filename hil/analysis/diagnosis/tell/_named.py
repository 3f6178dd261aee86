"""The effects that are named, each with what it is sure of, and those that were looked at and are not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit._fit import Fit, carried
from hil.analysis.diagnosis.fit._problem import Problem
from hil.analysis.diagnosis.fit._simulated import simulated_samples
from hil.analysis.diagnosis.search._search import Found
from hil.analysis.diagnosis.search._thresholds import LEAST_EVIDENCE
from hil.analysis.diagnosis.tell._confidence import Sure
from hil.analysis.diagnosis.tell._corrections import is_correction
from hil.analysis.diagnosis.tell._given_back import GivenBack
from hil.analysis.diagnosis.tell._result import Considered, NamedEffect
from hil.analysis.diagnosis.tell._thresholds import NOTHING_SIGMAS
from hil.analysis.diagnosis.tell._words import Where, where
from hil.core.effects import EFFECTS
from hil.core.errors.wording import multiple
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]


def named_effects(
    problem: Problem,
    found: Found,
    sure: Sure,
    back: GivenBack,
    errors: Array,
    rounded: Sequence[EffectUse],
) -> tuple[NamedEffect, ...]:
    """The effects of the model given back, each with its errors, its place and how sure its name is.

    Args:
        errors: standard errors of the fit's coordinates.
        rounded: roundings of channels, which no fit needs.
    """
    kept = back.kept
    uses = kept.hypothesis.model(kept.theta).effects[len(kept.hypothesis.base.effects) :]
    named = []
    for index, use in enumerate(uses):
        if use.id == "parameter_mismatch" and is_correction(found, use, kept):
            continue  # an update, not a finding
        fewer = kept.hypothesis.without(index)
        theta = carried(kept, fewer)
        if use.id == "parameter_mismatch":  # without it the parameter is as it was
            names = [c.name if c.term < 0 else "" for c in fewer.coordinates()]
            theta[names.index(str(use.values["parameter"]))] = 0.0
        without = simulated_samples(problem, fewer, theta, kept.starts)
        standard = {}
        for c, error in zip(kept.hypothesis.coordinates(), errors, strict=True):
            if c.term == index:
                value = float(use.values[c.name])
                standard[c.name] = float(error * (abs(value) if c.scale == "log" else 1.0))
            if use.id == "parameter_mismatch" and c.term < 0 and c.name == use.values["parameter"]:
                standard["value"] = float(error) * float(use.values["value"])
        place = where(problem, without, back.after.samples, back.before.map, back.after.map)
        named.append(NamedEffect(clean(use), standard, sure.confidences[index], place, sure.drops[index]))
    for use in rounded:
        place = Where(
            (str(use.values["channel"]),),
            (0.0, round(0.5 / problem.traces[0].dt, 1)),
            "at all operating conditions",
        )
        named.append(NamedEffect(use, {"step": 0.0}, 0.99, place))
    return tuple(named)


def considered(problem: Problem, found: Found, kept: Fit) -> tuple[Considered, ...]:
    """Effects that were looked at and not named, the likeliest first."""
    named = set(kept.hypothesis.keys)
    rows: dict[tuple[str, str], Considered] = {}
    for step in found.steps:
        fitted = {f.hypothesis.keys[-1]: f for f in step.fits}
        for score in step.scores:
            if score.key in named or score.key in rows:
                continue
            one = fitted.get(score.key)
            left = None if one is None else float(np.sqrt(one.cost / problem.rows))
            rows[score.key] = Considered(
                *score.key, float(score.gain), left, _reason(one, score.gain, step.fits)
            )
    return tuple(sorted(rows.values(), key=lambda c: -c.score))


def lasting(model: Model) -> list[EffectUse]:
    """Effects that a model file keeps: a corrected parameter stands among the parameters."""
    lasting = []
    for use in model.effects:
        if use.id == "parameter_mismatch":
            continue
        values = dict(use.values)
        if "phase_rad" in values:
            values = dict(clean(use).values)
        lasting.append(EffectUse(use.id, values))
    return lasting


def reduced(effects: Sequence[NamedEffect]) -> list[str]:
    """What to say of an effect whose own number is nothing and which is named for another of its numbers."""
    lines = []
    for one in effects:
        effect, values = EFFECTS[one.use.id], one.use.values
        main = next(iter(effect.sizes), "")  # none where any number alone makes it act
        error = one.standard_error.get(main)
        if error is None or abs(float(values[main])) > NOTHING_SIGMAS * error:
            continue
        fitted = [effect.parameter(name) for name in values if name != main and name in one.standard_error]
        acting = [f"{p.name} = {float(values[p.name]):.4g} {p.unit}, {p.meaning}" for p in fitted]
        own = f"{float(values[main]):.2g} ± {error:.2g} {effect.parameter(main).unit}"
        if acting:
            words = "; ".join(acting)
            lines.append(f"of {one.use.id} the {main} itself is nothing ({own}); what acts is {words}")
    return lines


def clean(use: EffectUse) -> EffectUse:
    """Phases within ±π; optional values that were not fitted left out."""
    values = dict(use.values)
    if "phase_rad" in values:
        values["phase_rad"] = float((float(values["phase_rad"]) + np.pi) % (2 * np.pi) - np.pi)
    for parameter in EFFECTS[use.id].parameters:
        if parameter.optional and values.get(parameter.name) == parameter.default:
            del values[parameter.name]
    return EffectUse(use.id, values)


def _reason(one: Fit | None, gain: float, fits: list[Fit]) -> str:
    if gain <= 0.0:
        return "by its linearised score it explains nothing"
    if gain < LEAST_EVIDENCE:
        return "no evidence: the drop is what noise would give"
    if one is None and not fits:
        return "promises too small a share of what is left by its linearised score; not fitted"
    if one is None:
        return "explains far less than the best by its linearised score; not fitted"
    if fits and one is not fits[0]:
        return f"leaves {multiple(np.sqrt(one.cost / fits[0].cost))} the gap of {fits[0].hypothesis.ids[-1]}"
    return "closes too small a share of what is left"
