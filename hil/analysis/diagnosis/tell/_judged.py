"""What a search found, told: gaps before and after, effects with errors and places, what was rejected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data._gap import ChannelGap, GapMap, channel_gaps, gap_map, made_worse
from hil.analysis.diagnosis.data._sanity import Examined
from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._covariance import standard_errors
from hil.analysis.diagnosis.fit._fit import Fit, carried, fit
from hil.analysis.diagnosis.fit._problem import Problem, problem_of
from hil.analysis.diagnosis.fit._simulated import settled_starts, simulated_samples
from hil.analysis.diagnosis.fit._thresholds import TOLERANCE
from hil.analysis.diagnosis.search._alignment import has_ripple
from hil.analysis.diagnosis.search._from_base import moved
from hil.analysis.diagnosis.search._search import Found
from hil.analysis.diagnosis.search._thresholds import LEAST_EVIDENCE
from hil.analysis.diagnosis.search._tracking import track
from hil.analysis.diagnosis.tell._as_likely import as_likely
from hil.analysis.diagnosis.tell._confidence import alternatives_of, confidence_of, drop_of
from hil.analysis.diagnosis.tell._consequences import consequences
from hil.analysis.diagnosis.tell._drift import drifts
from hil.analysis.diagnosis.tell._least import worth_naming
from hil.analysis.diagnosis.tell._result import Considered, Diagnosis, NamedEffect, Overlay, Start, Verdict
from hil.analysis.diagnosis.tell._thresholds import CHANNEL_NOISES, SPOILT
from hil.analysis.diagnosis.tell._words import Where, signature, where
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]

NUMBERS_TRADE = (
    "other numbers of the base model would only trade one channel's error for another's: it stays as it came"
)


@dataclass
class Judged:
    """What the search found, simulated and compared."""

    problem: Problem
    found: Found
    verdict: Verdict
    holdout: Examined
    by_chance: float | None = None
    #: Smallest sizes worth naming that a user set, by effect.
    least: Mapping[str, float] = field(default_factory=dict)
    #: Why the search ended before it was through, if it did.
    unfinished: str = ""

    def diagnosis(self, rounded: list[EffectUse], notes: list[str], seconds: float) -> Diagnosis:
        base, best = self.found.base, self.found.best
        verdict = self.verdict
        kept = best if verdict == "named" and best.hypothesis.terms else base
        problem = self.problem
        colouring = self.found.evidence.colouring(self.found.best)
        floor = problem.floor * colouring
        given = self._as_it_came(problem)
        before = simulated_samples(problem, *given)
        after = simulated_samples(problem, kept.hypothesis, kept.theta, kept.starts)
        map_before, map_after = (gap_map(problem.traces, problem.noise, s) for s in (before, after))
        gap_before, gap_after = (channel_gaps(problem.traces, floor, s) for s in (before, after))
        worse = made_worse(map_before, map_after)
        if verdict == "unknown" and (
            _trades(gap_before, gap_after) or (worse and not _gains(gap_before, gap_after))
        ):
            hypothesis, theta, starts = given
            kept = fit(problem, hypothesis, starts, theta, rounds=0)
            after, map_after, gap_after, worse = before, map_before, gap_before, []
            notes = [*notes, NUMBERS_TRADE]
        errors = standard_errors(problem, kept)
        model = kept.hypothesis.model(kept.theta)
        updates, kept_parameters = self._updates(kept, errors)
        model = model.with_parameters(**kept_parameters)
        tail = tuple(rounded) if verdict == "named" else ()
        model = model.with_effects(*_lasting(model), *tail)
        held_before, held_after = self._held(kept)
        effects = (
            self._effects(kept, errors, after, map_before, map_after, rounded) if verdict == "named" else ()
        )
        traces = problem.traces
        small = [e for e in effects if not worth_naming(e.use, traces, self.least, base.hypothesis.base)]
        effects = tuple(e for e in effects if e not in small)
        if verdict == "named" and not effects:
            # Small corrections were all that was found: do they explain the data?
            verdict = "none" if self.found.evidence.closed(kept) else "unknown"
        if verdict == "none":
            notes = [*notes, *_held_out_open(held_after)]
        overlays = tuple(
            Overlay(t.name, t.dt, t.torque, t.samples, b, a)
            for t, b, a in zip(problem.traces, before, after, strict=True)
        )
        return Diagnosis(
            verdict=verdict,
            base=base.hypothesis.base,
            model=model,
            effects=effects,
            parameter_updates=updates | _as_corrections(small),
            alternatives=alternatives_of(self.found, verdict),
            considered=self._considered(kept),
            gap_before=gap_before,
            gap_after=gap_after,
            holdout_before=held_before,
            holdout_after=held_after,
            map_before=map_before,
            map_after=map_after,
            signature=self._signature(kept, gap_after, map_after, after) if verdict == "unknown" else "",
            overlays=overlays,
            notes=(*notes, *(drifts(problem, after) if verdict == "none" else ())),
            seconds=seconds,
            by_chance=self.by_chance,
            consequences=consequences(base.hypothesis.base, model, as_likely(kept, errors)),
            start=self._start(kept, errors, floor),
            open_channels=self._open(kept),
            unfinished=self.unfinished,
            worse=tuple(worse),
        )

    def _start(self, kept: Fit, errors: Array, floor: Array) -> Start | None:
        """The numbers that had to change where the base model was far off, as they are in the end."""
        if not kept.hypothesis.far:
            return None
        given, new = kept.hypothesis.base.parameters, kept.hypothesis.model(kept.theta).parameters
        wrong = moved(kept)
        parameters = {
            c.name: (given[c.name], new[c.name], new[c.name] * float(error))
            for c, error in zip(kept.hypothesis.coordinates(), errors, strict=True)
            if c.term < 0 and c.name in wrong
        }
        base = self.found.base
        shown = simulated_samples(self.problem, base.hypothesis, base.theta, base.starts)
        names = tuple(t.name for t in self.problem.traces)
        return Start(parameters, names, channel_gaps(self.problem.traces, floor, shown))

    def _signature(self, kept: Fit, gaps: dict[str, ChannelGap], by_place: GapMap, after: list[Array]) -> str:
        """How much stays that neither the model nor a proven noise accounts for, and what it looks like."""
        worst = max(gaps, key=lambda channel: gaps[channel].noises)
        share = f"{100.0 * gaps[worst].gap:.3g} % of {worst}"
        size = f"{share} stay unexplained, {gaps[worst].noises:.3g} times its noise"
        tried = self.found.best.hypothesis.ids
        if not tried and self.unfinished:
            fits = [f for step in self.found.steps[:1] for f in step.fits[:1]]
            tried = fits[0].hypothesis.ids if fits else ()
        closest = f"; closest, and not close enough: {', '.join(tried)}" if tried else ""
        drifting = drifts(self.problem, after)
        looks = (
            []
            if any(words.startswith(worst) for words in drifting)
            else [signature(self.problem, kept, by_place)]
        )
        return "; ".join([size, *drifting, *looks]) + closest

    def _open(self, kept: Fit) -> tuple[str, ...]:
        """Channels that keep more than noise is proven to be."""
        gaps = self.found.evidence.gaps(kept)
        return tuple(channel for channel, gap in zip(OUTPUTS, gaps, strict=True) if gap > CHANNEL_NOISES)

    def _as_it_came(self, problem: Problem) -> tuple[Hypothesis, Array, list[Array]]:
        """The base model with its own numbers, and the initial values that suit it best."""
        hypothesis = replace(self.found.base.hypothesis, far=False)
        theta = hypothesis.start()
        return hypothesis, theta, settled_starts(problem, hypothesis, theta, self.found.base.starts)

    def _held(self, kept: Fit) -> tuple[dict[str, ChannelGap], dict[str, ChannelGap]]:
        if not self.holdout.traces:
            return {}, {}
        noise = self.holdout.noise
        colouring = self.found.evidence.colouring(self.found.best)
        weighed = np.where(np.isfinite(self.problem.noise), self.problem.noise, noise)  # rounding included
        problem = problem_of(
            self.holdout.traces,
            weighed,
            self.problem.gear_ratio,
            floor=noise * colouring,
            functions=self.problem.functions,
        )
        gaps = []
        for hypothesis, theta in (
            (self.found.base.hypothesis, self.found.base.hypothesis.start()),
            (kept.hypothesis, kept.theta),
        ):
            starts = settled_starts(problem, hypothesis, theta, problem.first_starts())
            if has_ripple(hypothesis):
                followed = problem.following(hypothesis, theta)
                _, problem = track(followed, hypothesis, theta, starts, order_known=True, phase_known=True)
                starts = settled_starts(problem, hypothesis, theta, starts)
            shown = simulated_samples(problem, hypothesis, theta, starts)
            gaps.append(channel_gaps(problem.traces, problem.floor, shown))
        return gaps[0], gaps[1]

    def _updates(
        self, kept: Fit, errors: Array
    ) -> tuple[dict[str, tuple[float, float, float]], dict[str, float]]:
        """Corrections of base parameters beyond what noise explains, and all parameters as fitted."""
        model = kept.hypothesis.model(kept.theta)
        base = kept.hypothesis.base.parameters
        wrong = {
            use.values["parameter"]
            for use in model.effects
            if use.id == "parameter_mismatch" and not self._correction(use, kept)
        }
        updates = {}
        if kept.hypothesis.far:
            wrong |= {*moved(kept)}  # under `start`
        for c, error in zip(kept.hypothesis.coordinates(), errors, strict=True):
            if c.term >= 0 or c.name in wrong:
                continue
            old, new = base[c.name], model.parameters[c.name]
            if abs(np.log(new / old)) < 2.0 * error:
                continue
            updates[c.name] = (old, new, new * float(error))
        return updates, dict(model.parameters)

    def _effects(
        self,
        kept: Fit,
        errors: Array,
        after: list[Array],
        map_before: GapMap,
        map_after: GapMap,
        rounded: list[EffectUse],
    ) -> tuple[NamedEffect, ...]:
        uses = kept.hypothesis.model(kept.theta).effects[len(kept.hypothesis.base.effects) :]
        named = []
        for index, use in enumerate(uses):
            if use.id == "parameter_mismatch" and self._correction(use, kept):
                continue  # an update, not a finding
            fewer = kept.hypothesis.without(index)
            theta = carried(kept, fewer)
            if use.id == "parameter_mismatch":  # without it the parameter is as it was
                names = [c.name if c.term < 0 else "" for c in fewer.coordinates()]
                theta[names.index(str(use.values["parameter"]))] = 0.0
            without = simulated_samples(self.problem, fewer, theta, kept.starts)
            standard = {}
            for c, error in zip(kept.hypothesis.coordinates(), errors, strict=True):
                if c.term == index:
                    value = float(use.values[c.name])
                    standard[c.name] = float(error * (abs(value) if c.scale == "log" else 1.0))
                if use.id == "parameter_mismatch" and c.term < 0 and c.name == use.values["parameter"]:
                    standard["value"] = float(error) * float(use.values["value"])
            place = where(self.problem, without, after, map_before, map_after)
            sure, drop = confidence_of(self.found, index), drop_of(self.found, index)
            named.append(NamedEffect(_clean(use), standard, sure, place, drop))
        for use in rounded:
            place = Where(
                (str(use.values["channel"]),),
                (0.0, round(0.5 / self.problem.traces[0].dt, 1)),
                "at all operating conditions",
            )
            named.append(NamedEffect(use, {"step": 0.0}, 0.99, place))
        return tuple(named)

    def _correction(self, mismatch: EffectUse, kept: Fit) -> bool:
        """Whether a parameter is off by no more than its tolerance, or it cannot be told that it is.

        Beside friction or contact by a law that is not quite the right one a parameter makes up for what the
        formula misses, as a shafts' damping does for flanks that damp otherwise.
        """
        if _within_tolerance(mismatch, kept.hypothesis.base.parameters):
            return True
        return kept.hypothesis.of_many_laws and not self.found.evidence.closed(kept)

    def _considered(self, kept: Fit) -> tuple[Considered, ...]:
        named = set(kept.hypothesis.keys)
        rows: dict[tuple[str, str], Considered] = {}
        for step in self.found.steps:
            fitted = {f.hypothesis.keys[-1]: f for f in step.fits}
            for score in step.scores:
                if score.key in named or score.key in rows:
                    continue
                one = fitted.get(score.key)
                left = None if one is None else float(np.sqrt(one.cost / self.problem.rows))
                rows[score.key] = Considered(
                    *score.key, float(score.gain), left, _reason(one, score.gain, step.fits)
                )
        return tuple(sorted(rows.values(), key=lambda c: -c.score))


def _reason(one: Fit | None, gain: float, fits: list[Fit]) -> str:
    if gain < LEAST_EVIDENCE:
        return "no evidence: the drop is what noise would give"
    if one is None:
        return "explains far less than the best by its linearised score; not fitted"
    if fits and one is not fits[0]:
        return f"leaves {np.sqrt(one.cost / fits[0].cost):.3g} times the gap of {fits[0].hypothesis.ids[-1]}"
    return "closes too small a share of what is left"


def _as_corrections(small: Sequence[NamedEffect]) -> dict[str, tuple[float, float, float]]:
    """Effects too small to be named, as corrections of numbers that were where they do nothing."""
    found = {}
    for effect in small:
        about = [str(v) for v in effect.use.values.values() if isinstance(v, str)]
        for name, error in effect.standard_error.items():
            neutral = EFFECTS[effect.use.id].off if name in EFFECTS[effect.use.id].acting() else 0.0
            key = ".".join([effect.use.id, *about, name])
            found[key] = (neutral, float(effect.use.values[name]), error)
    return found


def _clean(use: EffectUse) -> EffectUse:
    """Phases within ±π; optional values that were not fitted left out."""
    values = dict(use.values)
    if "phase_rad" in values:
        values["phase_rad"] = float((float(values["phase_rad"]) + np.pi) % (2 * np.pi) - np.pi)
    for parameter in EFFECTS[use.id].parameters:
        if parameter.optional and values.get(parameter.name) == parameter.default:
            del values[parameter.name]
    return EffectUse(use.id, values)


def _lasting(model: Model) -> list[EffectUse]:
    """Effects that a model file keeps: a corrected parameter stands among the parameters."""
    lasting = []
    for use in model.effects:
        if use.id == "parameter_mismatch":
            continue
        values = dict(use.values)
        if "phase_rad" in values:
            values = dict(_clean(use).values)
        lasting.append(EffectUse(use.id, values))
    return lasting


def _within_tolerance(use: EffectUse, base: dict[str, float]) -> bool:
    """Whether a parameter is off by no more than its stated calibration tolerance."""
    ratio = float(use.values["value"]) / base[str(use.values["parameter"])]
    return bool(abs(np.log(ratio)) <= TOLERANCE)


def _trades(was: Mapping[str, ChannelGap], is_: Mapping[str, ChannelGap]) -> bool:
    """Whether fitted numbers leave a channel clearly further from its measurement than it was."""
    return any(is_[c].gap > SPOILT * was[c].gap and is_[c].noises > CHANNEL_NOISES for c in is_)


def _gains(was: Mapping[str, ChannelGap], is_: Mapping[str, ChannelGap]) -> bool:
    """Whether they bring any channel clearly nearer."""
    return any(was[c].gap > SPOILT * is_[c].gap for c in is_)


def _held_out_open(gaps: Mapping[str, ChannelGap]) -> list[str]:
    """What to say where recordings that no fit has seen disagree, and those that were fitted do not."""
    return [
        f"held-out recordings leave {gap.noises:.3g} times its noise in {channel}: something is missing that "
        "the recordings fitted do not show; give those held out as recordings too"
        for channel, gap in gaps.items()
        if gap.noises > 2.0 * CHANNEL_NOISES
    ]
