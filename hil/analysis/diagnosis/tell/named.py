"""The effects that are named, each with what it is sure of, and those that are not, or do not matter.

What does not matter is smaller than what a bench's instruments are good to.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.fit.fit import Fit, started_from
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import simulated_samples
from hil.analysis.diagnosis.fit.thresholds import TOLERANCE
from hil.analysis.diagnosis.search.search import Found
from hil.analysis.diagnosis.search.thresholds import LEAST_EVIDENCE
from hil.analysis.diagnosis.tell.confidence import Sure
from hil.analysis.diagnosis.tell.corrections import is_correction
from hil.analysis.diagnosis.tell.given_back import GivenBack
from hil.analysis.diagnosis.tell.result import Considered, NamedEffect
from hil.analysis.diagnosis.tell.thresholds import NOTHING_SIGMAS, OF_A_FILTER, TOLERANCES
from hil.analysis.diagnosis.tell.words import Where, where
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.errors.wording import multiple
from hil.core.model import EffectUse, Model


def belongs_to_filter(use: EffectUse, beside: Sequence[EffectUse], dt: float) -> bool:
    """Whether a channel that is early is only what a filter that runs with the samples does.

    Such a filter, y += share·(x - y), passes a share of the newest sample at once: a low-pass of its time
    constant, but for an advance of half a sample.
    """
    if use.id != "channel_skew" or not -OF_A_FILTER * dt <= float(use.values["delay_s"]) < 0.0:
        return False
    return any(e.id == "sensor_lag" and e.values["channel"] == use.values["channel"] for e in beside)


def worth_naming(use: EffectUse, traces: Sequence[Trace], least: Mapping[str, float], base: Model) -> bool:
    """Whether an effect is at least as large as the smallest size worth a name.

    An extra dead time adds to the model's own, and is no finding within what that may be off by.

    Args:
        least: sizes that a user set, by effect, in the unit of the effect's first number.
    """
    effect = EFFECTS[use.id]
    known = effect.completed(use.values)
    size = max(abs(float(known[name]) - effect.off) for name in effect.acting())
    if use.id in least:
        return size >= least[use.id]
    if use.id == "dead_time":
        own = base.dead_time_s * base.tolerance.get("torque_delay", TOLERANCE)
        if size < TOLERANCES * own:
            return False
    if effect.least is None:
        return True
    unit = 1.0
    if effect.least.of == "samples":
        unit = traces[0].dt
    elif effect.least.of == "largest torque":
        unit = max(float(np.max(np.abs(t.torque))) for t in traces)
    elif effect.least.of == "rms reading":
        column = OUTPUTS.index(str(use.values["channel"]))
        readings = np.concatenate([t.samples[:, column] for t in traces if t.has[column]])
        unit = float(np.sqrt(np.mean(readings**2)))
    return size >= effect.least.amount * unit


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
        theta = started_from(kept, fewer)
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
