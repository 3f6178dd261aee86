"""The model that is given back, and the one that came, simulated on the recordings that were fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.gap import ChannelGap, GapMap, channel_gaps, gap_map, made_worse
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import settled_starts, simulated_samples
from hil.analysis.diagnosis.search.search import Found
from hil.analysis.diagnosis.tell.result import Verdict
from hil.analysis.diagnosis.tell.thresholds import CHANNEL_NOISES, HALVED, SPOILT

Array = npt.NDArray[np.float64]

NUMBERS_TRADE = (
    "other numbers of the base model would only trade one channel's error for another's: it stays as it came"
)


@dataclass(frozen=True)
class Shown:
    """Channels of each recording at full rate (n x 3), their gaps, and where the gap is."""

    samples: list[Array]
    gaps: dict[str, ChannelGap]
    map: GapMap


@dataclass(frozen=True)
class GivenBack:
    """The fit that is given back as the model, and what it and the model as it came leave."""

    kept: Fit
    before: Shown
    after: Shown

    @property
    def worse(self) -> list[str]:
        """Where the model given back is further off than the one that came, in words."""
        return made_worse(self.before.map, self.after.map)

    @property
    def trades(self) -> bool:
        """Whether its numbers leave anything further off, and not every channel far nearer for it."""
        was, is_ = self.before.gaps, self.after.gaps
        return _spoils(was, is_) or bool(self.worse and not _halves(was, is_))


def given_back(problem: Problem, found: Found, verdict: Verdict, floor: Array) -> tuple[GivenBack, list[str]]:
    """What is given back, and notes on it: without a name no number may spoil a channel for another.

    Args:
        floor: standard deviation of each channel's noise per sample, shape (3,).
    """
    kept = found.best if verdict == "named" and found.best.hypothesis.terms else found.base
    hypothesis, theta, starts = _as_it_came(problem, found)
    before = _shown(problem, floor, hypothesis, theta, starts)
    starts = kept.starts
    if verdict != "named":  # far from the noise a fit is drawn away from rest
        starts = settled_starts(problem, kept.hypothesis, kept.theta, starts)
    back = GivenBack(kept, before, _shown(problem, floor, kept.hypothesis, kept.theta, starts))
    if verdict == "unknown" and back.trades:
        return GivenBack(fit(problem, hypothesis, starts, theta, rounds=0), before, before), [NUMBERS_TRADE]
    return back, []


def _shown(
    problem: Problem, floor: Array, hypothesis: Hypothesis, theta: Array, starts: list[Array]
) -> Shown:
    samples = simulated_samples(problem, hypothesis, theta, starts)
    return Shown(
        samples,
        channel_gaps(problem.traces, floor, samples),
        gap_map(problem.traces, problem.noise, samples),
    )


def _as_it_came(problem: Problem, found: Found) -> tuple[Hypothesis, Array, list[Array]]:
    """The base model with its own numbers, and the initial values that suit it best."""
    hypothesis = replace(found.base.hypothesis, far=False)
    theta = hypothesis.start()
    return hypothesis, theta, settled_starts(problem, hypothesis, theta, found.base.starts)


def _spoils(was: Mapping[str, ChannelGap], is_: Mapping[str, ChannelGap]) -> bool:
    """Whether fitted numbers leave a channel clearly further from its measurement than it was."""
    return any(is_[c].gap > SPOILT * was[c].gap and is_[c].noises > CHANNEL_NOISES for c in is_)


def _halves(was: Mapping[str, ChannelGap], is_: Mapping[str, ChannelGap]) -> bool:
    """Whether they leave half at most of the gap of each channel that had more than noise."""
    return all(is_[c].gap < HALVED * was[c].gap for c in is_ if was[c].noises > CHANNEL_NOISES)
