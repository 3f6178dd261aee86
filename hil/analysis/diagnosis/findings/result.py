"""What a diagnosis found, and its form in `diagnosis.json` (docs/reference/diagnosis.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.gap import BANDS_HZ, ChannelGap, GapMap
from hil.analysis.diagnosis.findings.named import Where
from hil.analysis.missing_effects import Curve, Verdict
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.files.toml_file import FORMAT
from hil.core.model import EffectUse, Model, parameter_of_effect

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class NamedEffect:
    """An effect that the data show; `confidence` is the chance that the name is right.

    `alike` are names that the data cannot tell from it: they share the confidence.
    """

    use: EffectUse
    standard_error: dict[str, float]
    confidence: float
    where: Where
    alike: tuple[str, ...] = ()

    @property
    def class_(self) -> str:
        """Its name and those that the data cannot tell from it; empty where it stands alone."""
        return " or ".join((EFFECTS[self.use.id].label(self.use.values), *self.alike)) if self.alike else ""


def as_corrections(small: Sequence[NamedEffect]) -> dict[str, tuple[float, float, float]]:
    """Effects too small to be named, as corrections of numbers that were where they do nothing.

    Each as it was, as it is now, and its standard error.
    """
    found = {}
    for effect in small:
        for name, error in effect.standard_error.items():
            neutral = EFFECTS[effect.use.id].off if name in EFFECTS[effect.use.id].acting() else 0.0
            found[parameter_of_effect(effect.use, name)] = (neutral, float(effect.use.values[name]), error)
    return found


@dataclass(frozen=True)
class Alternative:
    """Another name for the same gap, and the test that would tell the two apart.

    `instead_of` is the label of the named effect that it would take the place of; '' where none is named.
    """

    use: EffectUse
    confidence: float
    separating_test: str
    plan: str | None = None
    plan_text: str | None = None
    instead_of: str = ""


@dataclass(frozen=True)
class Overlay:
    """Measured, and simulated before and after, of one recording at full rate: n x 3 each; `dt` in s."""

    name: str
    dt: float
    torque: Array
    measured: Array
    before: Array
    after: Array


@dataclass(frozen=True)
class Start:
    """A base model that was far from the data, and was identified before physics was looked for.

    `parameters` by name: as given, as in the model given back, standard error. `gap` is what other numbers
    leave without any effect.
    """

    parameters: dict[str, tuple[float, float, float]]
    recordings: tuple[str, ...]
    gap: dict[str, ChannelGap]

    def as_json(self) -> dict[str, Any]:
        """As `start` of diagnosis.json."""
        return {
            "parameters": {
                name: {"from": a, "to": b, "standard_error": s} for name, (a, b, s) in self.parameters.items()
            },
            "recordings": list(self.recordings),
            "gap": {channel: g.gap for channel, g in self.gap.items()},
        }


@dataclass(frozen=True)
class Diagnosis:
    """All that a diagnosis has to say; ratios of gaps are those of docs/reference/diagnosis.md."""

    verdict: Verdict
    base: Model
    model: Model
    effects: tuple[NamedEffect, ...]
    parameter_updates: dict[str, tuple[float, float, float]]  # from, to, standard error
    alternatives: tuple[Alternative, ...]
    gap_before: dict[str, ChannelGap]
    gap_after: dict[str, ChannelGap]
    holdout_before: dict[str, ChannelGap]
    holdout_after: dict[str, ChannelGap]
    map_before: GapMap
    map_after: GapMap
    signature: str
    overlays: tuple[Overlay, ...]
    notes: tuple[str, ...]
    seconds: float = 0.0
    consequences: dict[str, dict[str, float]] = field(default_factory=dict)
    start: Start | None = None
    #: Channels whose gap stays above what is proven to be noise.
    open_channels: tuple[str, ...] = ()
    #: The same of recordings held out; with `none` those that keep more than slow noise may be.
    held_out_open: tuple[str, ...] = ()
    #: Why the search ended before it was through, if it did: this is what was known by then.
    unfinished: str = ""
    #: Where the model given back is further off than the one that came, in words.
    worse: tuple[str, ...] = ()
    #: Torques that are missing, as measured, beside the laws of their names.
    curves: tuple[Curve, ...] = ()
    #: Gaps of angles that were recorded in place of a speed, before and after; of fitted and held-out ones.
    angles: dict[str, tuple[ChannelGap, ChannelGap]] = field(default_factory=dict)
    holdout_angles: dict[str, tuple[ChannelGap, ChannelGap]] = field(default_factory=dict)

    @property
    def something_else(self) -> float:
        """Probability that what is missing, or more that is, has no name here."""
        if self.verdict == "none":
            return 0.0
        named = min((one.confidence for one in self.effects), default=0.0)
        others = sum(one.confidence for one in self.alternatives if not self.class_of(one))
        return max(0.0, 1.0 - named - others)

    def class_of(self, other: Alternative) -> str:
        """The class of names, which the data cannot tell apart, that an alternative is in; empty without."""
        label = EFFECTS[other.use.id].label(other.use.values)
        return next((one.class_ for one in self.effects if label in one.alike), "")

    def as_json(self) -> dict[str, Any]:
        """The content of `diagnosis.json`."""
        return {
            "format": FORMAT,
            "verdict": self.verdict,
            **({"unfinished": self.unfinished} if self.unfinished else {}),
            "effects": [_effect(e) for e in self.effects],
            "something_else": round(self.something_else, 3),
            **({"start": self.start.as_json()} if self.start is not None else {}),
            "parameter_updates": {
                name: {"from": a, "to": b, "standard_error": s}
                for name, (a, b, s) in self.parameter_updates.items()
            },
            "alternatives": [
                {
                    "id": a.use.id,
                    "parameters": dict(a.use.values),
                    "confidence": round(a.confidence, 3),
                    **({"class": of} if (of := self.class_of(a)) else {}),
                    "separating_test": a.separating_test,
                    **({"plan": a.plan} if a.plan else {}),
                }
                for a in self.alternatives
            ],
            "gap": _gaps(self.gap_before, self.gap_after, self.angles),
            "holdout_gap": _gaps(self.holdout_before, self.holdout_after, self.holdout_angles),
            "map": _map(self.map_before, self.map_after),
            "open_channels": list(self.open_channels),
            "held_out_open": list(self.held_out_open),
            "made_worse": list(self.worse),
            "remaining_gap": self.signature,
            "consequences": self.consequences,
            "notes": list(self.notes),
            "model": "model.toml",
        }


def _map(before: GapMap, after: GapMap) -> dict[str, Any]:
    """Error over noise, recordings x channels x bands."""
    return {
        "recordings": list(before.recordings),
        "channels": list(OUTPUTS),
        "bands_hz": [list(band) for band in BANDS_HZ],
        "before": _or_none(before.by_band),
        "after": _or_none(after.by_band),
    }


def _or_none(values: Array) -> Any:
    shown = np.round(values, 3).astype(object)
    shown[~np.isfinite(values)] = None
    return shown.tolist()


def _effect(effect: NamedEffect) -> dict[str, Any]:
    return {
        "id": effect.use.id,
        "parameters": dict(effect.use.values),
        "standard_error": effect.standard_error,
        "derived": derived_of(effect.use),
        "confidence": round(effect.confidence, 3),
        **({"class": effect.class_} if effect.alike else {}),
        "where": {
            "channels": list(effect.where.channels),
            "band_hz": list(effect.where.band_hz),
            "condition": effect.where.condition,
        },
    }


def derived_of(use: EffectUse) -> dict[str, float]:
    """Numbers of an effect that users know beside the fitted ones, by names that end in their units."""
    effect = EFFECTS[use.id]
    known = effect.completed(use.values).items()
    numbers = {name: value for name, value in known if not isinstance(value, str)}
    return dict(effect.derived(numbers)) if effect.derived is not None else {}


def _gaps(
    before: dict[str, ChannelGap],
    after: dict[str, ChannelGap],
    angles: dict[str, tuple[ChannelGap, ChannelGap]],
) -> dict[str, dict[str, float]]:
    both = {name: (before[name], after[name]) for name in before} | angles
    return {
        name: {"before": had.gap, "after": has.gap, "noise_floor": had.noise_floor}
        for name, (had, has) in both.items()
    }
