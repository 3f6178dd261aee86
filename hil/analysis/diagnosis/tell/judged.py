"""What a search found, stated: gaps before and after, effects with errors and places, what was rejected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.sanity import Examined
from hil.analysis.diagnosis.fit.covariance import standard_errors
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.search import Found
from hil.analysis.diagnosis.tell.apart import as_likely
from hil.analysis.diagnosis.tell.confidence import Sure, alternatives_of
from hil.analysis.diagnosis.tell.consequences import consequences
from hil.analysis.diagnosis.tell.corrections import as_corrections, started, suiting_a_gap, updates
from hil.analysis.diagnosis.tell.drift import drifts
from hil.analysis.diagnosis.tell.given_back import GivenBack, given_back
from hil.analysis.diagnosis.tell.held_out import held_out
from hil.analysis.diagnosis.tell.named import (
    belongs_to_filter,
    considered,
    lasting,
    named_effects,
    reduced,
    worth_naming,
)
from hil.analysis.diagnosis.tell.result import Diagnosis, NamedEffect, Overlay, Verdict
from hil.analysis.diagnosis.tell.thresholds import CHANNEL_NOISES
from hil.analysis.diagnosis.tell.words import signature
from hil.core.channels import OUTPUTS
from hil.core.errors.wording import multiple, share
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]


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
    #: How sure names are, where these were fitted anew since.
    sure: Sure | None = None

    def diagnosis(self, rounded: list[EffectUse], notes: list[str], seconds: float) -> Diagnosis:
        """All of it. `rounded` are roundings of channels, `notes` what was done with the data."""
        problem, found, base = self.problem, self.found, self.found.base.hypothesis.base
        floor = problem.floor * found.evidence.colouring(found.best)
        back, trading = given_back(problem, found, self.verdict, floor)
        errors = standard_errors(problem, back.kept)
        sure = self.sure or (Sure.of(found) if self.verdict == "named" else Sure((), (), ()))
        named = named_effects(problem, found, sure, back, errors, rounded) if self.verdict == "named" else ()
        uses, dt = [e.use for e in named], problem.traces[0].dt
        small = [
            e
            for e in named
            if not worth_naming(e.use, problem.traces, self.least, base) or belongs_to_filter(e.use, uses, dt)
        ]
        effects = tuple(e for e in named if e not in small)
        closes = self._closes(effects, back.kept)
        held = held_out(problem, self.holdout, found, back.kept)
        doubt = held.words(closes)
        # what no fit has seen and nothing explains is a gap like any other
        verdict: Verdict = "unknown" if closes == "none" and doubt else closes
        remaining = doubt if verdict != closes else self._signature(back) if verdict == "unknown" else ""
        model = back.kept.hypothesis.model(back.kept.theta)
        model = model.with_effects(*lasting(model), *(rounded if self.verdict == "named" else ()))
        corrected, open_channels = updates(found, back.kept, errors), self._open(back.kept)
        gaps = {channel: back.after.gaps[channel].noises for channel in open_channels}
        return Diagnosis(
            verdict=verdict,
            base=base,
            model=model,
            effects=effects,
            parameter_updates=corrected | as_corrections(small),
            alternatives=sure.alternatives if verdict == "named" else alternatives_of(found, verdict),
            considered=considered(problem, found, back.kept),
            gap_before=back.before.gaps,
            gap_after=back.after.gaps,
            holdout_before=held.before,
            holdout_after=held.after,
            map_before=back.before.map,
            map_after=back.after.map,
            signature=remaining,
            overlays=self._overlays(back),
            notes=(
                *notes,
                *trading,
                *reduced(effects),
                *suiting_a_gap(corrected, gaps),
                *(drifts(problem, back.after.samples) if verdict == "none" else ()),
                *([doubt] if verdict == "named" and doubt else ()),
            ),
            seconds=seconds,
            by_chance=self.by_chance,
            consequences=consequences(base, model, as_likely(back.kept, errors)),
            start=started(problem, found, back.kept, errors, floor),
            open_channels=open_channels,
            held_out_open=held.open(closes),
            unfinished=self.unfinished,
            worse=tuple(back.worse),
        )

    def _closes(self, effects: tuple[NamedEffect, ...], kept: Fit) -> Verdict:
        """The verdict on the recordings fitted: where small corrections are all, do they explain the data?"""
        if self.verdict != "named" or effects:
            return self.verdict
        return "none" if self.found.evidence.closed(kept) else "unknown"

    def _overlays(self, back: GivenBack) -> tuple[Overlay, ...]:
        return tuple(
            Overlay(t.name, t.dt, t.torque, t.samples, b, a)
            for t, b, a in zip(self.problem.traces, back.before.samples, back.after.samples, strict=True)
        )

    def _signature(self, back: GivenBack) -> str:
        """How much stays that neither the model nor a proven noise accounts for, and what it looks like."""
        gaps = back.after.gaps
        worst = max(gaps, key=lambda channel: gaps[channel].noises)
        gap = gaps[worst]
        size = f"{share(gap.gap, 2, digits=3)} of {worst} stay unexplained, {multiple(gap.noises)} its noise"
        tried = self.found.best.hypothesis.ids
        if not tried and self.unfinished:
            fits = [f for step in self.found.steps[:1] for f in step.fits[:1]]
            tried = fits[0].hypothesis.ids if fits else ()
        closest = f"; closest, and not close enough: {', '.join(tried)}" if tried else ""
        drifting = drifts(self.problem, back.after.samples)
        looks = (
            []
            if any(words.startswith(worst) for words in drifting)
            else [signature(self.problem, back.kept, back.after.map)]
        )
        return "; ".join([size, *drifting, *looks]) + closest

    def _open(self, kept: Fit) -> tuple[str, ...]:
        """Channels that keep more than noise is proven to be."""
        gaps = self.found.evidence.gaps(kept)
        return tuple(channel for channel, gap in zip(OUTPUTS, gaps, strict=True) if gap > CHANNEL_NOISES)
