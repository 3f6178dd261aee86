"""What one likelihood finds (`hil.analysis.missing_effects`), as a diagnosis: gaps, places, consequences."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.asked import Asked
from hil.analysis.diagnosis.data.gap import (
    CONDITIONS,
    ChannelGap,
    GapMap,
    HeldOut,
    channel_gap,
    channel_gaps,
    furthest,
    gap_map,
    made_worse,
)
from hil.analysis.diagnosis.findings.consequences import consequences
from hil.analysis.diagnosis.findings.named import Where, band_of_gap, clean, where_changed, worth_naming
from hil.analysis.diagnosis.findings.result import (
    Alternative,
    Diagnosis,
    NamedEffect,
    Overlay,
    Start,
    as_corrections,
)
from hil.analysis.diagnosis.findings.separating import most_of, plan_file, separating_plan, worth_a_plan
from hil.analysis.diagnosis.thresholds import VISIBLE
from hil.analysis.missing_effects import OUT_OF_TIME, Curve, Named, Outcome, Replay, Series, Verdict
from hil.core.channels import ANGLES, OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.errors.wording import multiple, share
from hil.core.model import EffectUse, Model
from hil.core.runtime.thread_map import map_on_threads

Array = npt.NDArray[np.float64]

ASK_FOR_CHAIN = (
    "transfer functions have no parts: what is missing inside the axle (play, friction, a mount, a tyre) "
    "cannot be added to them, nor can one of their numbers be corrected. Get the chain: 'hil run "
    "identification', then 'hil identify' on its recording writes physical.toml: give that as --model"
)

NUMBERS_TRADE = (
    "other numbers of the base model would only trade one channel's error for another's: it stays as it came"
)

NUMBERS_BENT = (
    "something is missing without a name, and bends the numbers of the model that is given back: they may be "
    "off by more than their errors say"
)


def diagnosis_of(
    found: Outcome,
    base: Model,
    asked: Asked,
    notes: Sequence[str] = (),
) -> Diagnosis:
    """An outcome as a diagnosis.

    Args:
        base: the model as it came.
        notes: on the data.
    """
    fitted, held = (_Shown.of(one, base, found.model, found.noise) for one in (found.fitted, found.held_out))
    if found.verdict == "unknown" and (fitted.has_grown or held.has_grown):
        return diagnosis_of(_as_it_came(found, base), base, asked, (*notes, NUMBERS_TRADE))
    named = tuple(_named(found, one, fitted) for one in found.effects)
    small = [one for one in named if not worth_naming(one.use, fitted.traces, asked.least, base)]
    effects = tuple(one for one in named if one not in small)
    follows = any(EFFECTS[use.id].law.follows for use in found.model.effects)
    walks = follows and not any(one.of_angle.any() for one in held.traces)
    event = furthest(held.traces, found.noise, held.after_samples)
    open_channels = _open(fitted.after)
    unseen = HeldOut(held.before, held.after, event, walks, fitted_too=bool(open_channels))
    verdict, remaining = _verdict(found, effects, unseen, fitted)
    doubt = unseen.words(verdict)
    start, updates = _numbers(found, fitted)
    stated = effects if verdict == "named" else ()
    is_bent = bool(stated and open_channels) or (verdict == "unknown" and bool(start or updates))
    small_too = {name for one in small for name in one.alike}
    return Diagnosis(
        verdict=verdict,
        base=base,
        model=found.model,
        effects=stated,
        parameter_updates=updates | as_corrections(small),
        alternatives=_alternatives(found, fitted, small_too),
        gap_before=fitted.before,
        gap_after=fitted.after,
        holdout_before=held.before,
        holdout_after=held.after,
        map_before=fitted.map_before,
        map_after=fitted.map_after,
        signature=remaining,
        overlays=held.overlays or fitted.overlays,
        notes=(
            *notes,
            *_classes([f for f, one in zip(found.effects, named, strict=True) if one in stated]),
            *_steadied(found),
            *([doubt] if doubt else ()),
            *([ASK_FOR_CHAIN] if base.transfer_functions and verdict == "unknown" else ()),
            *([NUMBERS_BENT] if is_bent else ()),
        ),
        seconds=found.seconds,
        unfinished=_time_is_up(asked) if found.unfinished == OUT_OF_TIME else found.unfinished,
        consequences=consequences(base, found.model, found.as_likely),
        start=start,
        open_channels=open_channels,
        held_out_open=unseen.open(verdict),
        worse=tuple(made_worse(fitted.map_before, fitted.map_after)),
        curves=_curves(found, stated),
        angles=_angles(found.fitted, found, base),
        holdout_angles=_angles(found.held_out, found, base),
    )


def _time_is_up(asked: Asked) -> str:
    return f"{asked.at_most_s / 60.0:.3g} min of processor time were up (--at-most)"


def _as_it_came(found: Outcome, base: Model) -> Outcome:
    """An outcome without a name that gives the model back as it came: its numbers would only trade errors."""
    return replace(
        found,
        model=base,
        numbers={},
        base_was_far=False,
        as_likely=(),
    )


@dataclass(frozen=True)
class _Shown:
    """Recordings at full rate beside the model as it came and the one given back."""

    replays: tuple[Replay, ...]
    traces: list[Series]
    before_samples: list[Array]
    after_samples: list[Array]
    before: dict[str, ChannelGap]
    after: dict[str, ChannelGap]
    map_before: GapMap
    map_after: GapMap

    @classmethod
    def of(cls, replays: tuple[Replay, ...], base: Model, model: Model, noise: Array) -> _Shown:
        """Both models on recordings; `noise` (3,) is a standard deviation of a sample."""
        traces = [one.series for one in replays]
        before, after = (_outputs(replays, each) for each in (base, model))
        gaps = [channel_gaps(traces, noise, samples) for samples in (before, after)]
        maps = [gap_map(traces, noise, samples) for samples in (before, after)]
        return cls(replays, traces, before, after, gaps[0], gaps[1], maps[0], maps[1])

    @property
    def has_grown(self) -> bool:
        """Whether the model given back leaves more of any channel than the one that came."""
        return any(one.gap > self.before[channel].gap for channel, one in self.after.items())

    @property
    def overlays(self) -> tuple[Overlay, ...]:
        """Measured and simulated of each recording."""
        every = zip(self.traces, self.before_samples, self.after_samples, strict=True)
        return tuple(
            Overlay(t.name, t.dt, t.torque, np.where(t.has, t.samples, np.nan), b, a) for t, b, a in every
        )


def _outputs(replays: Sequence[Replay], model: Model) -> list[Array]:
    """Of a model on each recording."""
    return map_on_threads(lambda one: one.outputs(model), replays)


def _curves(found: Outcome, effects: tuple[NamedEffect, ...]) -> tuple[Curve, ...]:
    """Torques of the effects named; where there are none what stays, if it follows anything at all."""
    labels = [EFFECTS[one.use.id].label(one.use.values) for one in effects]
    named = tuple(one for one in found.curves if one.effect in labels)
    stays = tuple(one for one in found.curves if not one.effect and one.share > 0.5)
    return named if effects else stays[:1]


def _angles(
    replays: Sequence[Replay], found: Outcome, base: Model
) -> dict[str, tuple[ChannelGap, ChannelGap]]:
    """Gaps of angles recorded in place of a speed, by the model as it came and by the one given back."""
    gaps = {}
    for column, channel in enumerate(OUTPUTS):
        read = [one for one in replays if one.series.of_angle[column]]
        if read and not any(one.series.lowest_hz > 0.0 for one in read):  # else it drifts as nothing decides
            measured = [one.series.angle[:, column] for one in read]
            noise = found.noise[column] * read[0].series.turned_over_s[column] / np.sqrt(2.0)  # of a reading
            both = (
                channel_gap(measured, [one.angle(model)[:, column] for one in read], float(noise))
                for model in (base, found.model)
            )
            gaps[ANGLES[channel]] = (next(both), next(both))
    return gaps


def _named(found: Outcome, one: Named, shown: _Shown) -> NamedEffect:
    """With the place where the simulations without an effect and with it differ most."""
    without = _without(found.model, one.use)
    if without is None:  # a rounding, or a number of the base
        recorded = [name for name, has in zip(OUTPUTS, shown.traces[0].has, strict=True) if has]
        channels = (str(one.use.values["channel"]),) if "channel" in one.use.values else tuple(recorded)
        band = (0.0, round(0.5 / shown.traces[0].dt, 1))
        place = Where(channels, band, "at all operating conditions")
    else:
        samples = _outputs(shown.replays, without)
        place = where_changed(
            shown.traces, found.noise, samples, shown.after_samples, shown.map_before, shown.map_after
        )
    return NamedEffect(clean(one.use), one.standard_error, one.confidence, place, alike=one.alike)


def _without(model: Model, use: EffectUse) -> Model | None:
    """The model without an effect; None where it is no effect of the model."""
    rest = [one for one in model.effects if one != use]
    return model.with_effects(*rest) if len(rest) < len(model.effects) else None


def _verdict(
    found: Outcome, effects: tuple[NamedEffect, ...], unseen: HeldOut, shown: _Shown
) -> tuple[Verdict, str]:
    """The verdict, and what stays where it is `unknown`: small effects are corrections, not findings."""
    verdict: Verdict = found.verdict
    if verdict == "named" and not effects:
        verdict = "unknown" if _open(shown.after) else "none"
    doubt = unseen.words(verdict)
    if verdict == "none" and doubt:
        return "unknown", doubt
    return verdict, _remaining(found, shown) if verdict == "unknown" else ""


def _remaining(found: Outcome, shown: _Shown) -> str:
    """How much stays, in which channel, band and condition, and what a latent torque follows."""
    worst = max(shown.after, key=lambda channel: shown.after[channel].noises)
    gap, column = shown.after[worst], OUTPUTS.index(worst)
    words = [f"{share(gap.gap, 2, digits=3)} of {worst} stay unexplained, {multiple(gap.noises)} its noise"]
    words.append(band_of_gap(shown.traces, found.noise, shown.after_samples, column))
    conditions = shown.map_after.by_condition[:, column]
    if np.count_nonzero(np.isfinite(conditions)) > 1:
        words.append(f"it is strongest at: {CONDITIONS[int(np.nanargmax(conditions))]}")
    stays = next((one for one in found.curves if not one.effect), None)
    if stays is not None and stays.share > 0.5:  # the larger part of it
        words.append(f"{share(stays.share)} of the torque that is missing follow {stays.over}")
    closest = ", ".join(one.id for one in found.alternatives[:2])
    return "; ".join(words) + (f"; closest, and not close enough: {closest}" if closest else "")


def _open(gaps: Mapping[str, ChannelGap]) -> tuple[str, ...]:
    return tuple(channel for channel, gap in gaps.items() if gap.noises > VISIBLE)


def _numbers(found: Outcome, shown: _Shown) -> tuple[Start | None, dict[str, tuple[float, float, float]]]:
    """Numbers of a base that was far off as a start, else those that moved beyond doubt as corrections."""
    moved = {name: (a, b, error) for name, (a, b, error) in found.numbers.items() if abs(b - a) > 2.0 * error}
    named = {str(one.use.values["parameter"]) for one in found.effects if one.id == "parameter_mismatch"}
    if not found.base_was_far:
        return None, {name: values for name, values in moved.items() if name not in named}
    gaps = channel_gaps(shown.traces, found.noise, _outputs(shown.replays, found.alone))
    return Start(moved, tuple(t.name for t in shown.traces), gaps), {}


def _alternatives(found: Outcome, shown: _Shown, small: Collection[str]) -> tuple[Alternative, ...]:
    """Other names, each with the test that separates it from what is given back.

    Args:
        small: names of the class of a correction, which are too small as well.
    """
    shared = {name: one.confidence for one in found.effects for name in one.alike}
    most = most_of(shown.traces, shown.after_samples)
    others = []
    for one in found.alternatives:
        label = EFFECTS[one.id].label(one.use.values)
        confidence = shared.get(label, one.confidence)
        if label in small or (found.effects and not round(confidence, 2)):
            continue  # it would be shown as 0
        text, plan = one.separating_test or EFFECTS[one.id].shown_by, ""
        instead_of = _place_of(found, one, label)
        pair = instead_of.partition("(")[0] or "numbers", one.id
        if one.model is not None and worth_a_plan(confidence, most):
            text, plan = separating_plan(found.model, one.model, found.noise, most, pair)
        name = plan_file(one.use) if plan else None
        others.append(Alternative(one.use, confidence, text, name, plan or None, instead_of))
    return tuple(others)


def _place_of(found: Outcome, rival: Named, label: str) -> str:
    """Label of the named effect that a rival of a label would replace; '' where none is named."""
    labels = {EFFECTS[one.id].label(one.use.values): one for one in found.effects}
    there = [EFFECTS[use.id].label(use.values) for use in rival.model.effects] if rival.model else []
    alike = [name for name, one in labels.items() if label in one.alike]
    return next(iter([*alike, *(name for name in labels if name not in there), *labels]), "")


def _steadied(found: Outcome) -> list[str]:
    """What keeps the model from drifting without a name."""
    if found.steadied is None:
        return []
    values = ", ".join(f"{name} = {value:.3g}" for name, value in found.steadied.values.items())
    return [
        f"without any loss the model would drift: it carries {found.steadied.id} ({values}), which is not "
        "named, as these recordings do not excite what tells losses apart: record a coast-down"
    ]


def _classes(effects: Sequence[Named]) -> list[str]:
    """Names that the data cannot tell from one another, with the test that would."""
    return [
        f"these recordings cannot tell {EFFECTS[one.id].label(one.use.values)} from "
        f"{' or '.join(one.alike)}: one of them is missing. What tells them apart: {one.separating_test}"
        for one in effects
        if one.alike
    ]
