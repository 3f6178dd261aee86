"""Recordings that no fit has seen: what the model leaves of them, and whether that is more than it may."""

from __future__ import annotations

import numpy as np

from hil.analysis.diagnosis.data._gap import ChannelGap, channel_gaps
from hil.analysis.diagnosis.data._sanity import Examined
from hil.analysis.diagnosis.fit._fit import Fit
from hil.analysis.diagnosis.fit._problem import Problem, problem_of
from hil.analysis.diagnosis.fit._simulated import settled_starts, simulated_samples
from hil.analysis.diagnosis.search._alignment import has_ripple
from hil.analysis.diagnosis.search._search import Found
from hil.analysis.diagnosis.search._tracking import track
from hil.analysis.diagnosis.tell._thresholds import CHANNEL_NOISES, SHUT_BY_LAW

Gaps = dict[str, ChannelGap]


def held_out_gaps(problem: Problem, holdout: Examined, found: Found, kept: Fit) -> tuple[Gaps, Gaps]:
    """Gaps of the recordings held out, with the model as it came and with `kept`; both empty without any.

    Only initial values are fitted to them and, with a ripple, the drift of the angle that it follows.
    """
    if not holdout.traces:
        return {}, {}
    noise = holdout.noise
    colouring = found.evidence.colouring(found.best)
    weighed = np.where(np.isfinite(problem.noise), problem.noise, noise)  # rounding included
    unseen = problem_of(
        holdout.traces,
        weighed,
        problem.gear_ratio,
        floor=noise * colouring,
        functions=problem.functions,
    )
    gaps = []
    for hypothesis, theta in (
        (found.base.hypothesis, found.base.hypothesis.start()),
        (kept.hypothesis, kept.theta),
    ):
        starts = settled_starts(unseen, hypothesis, theta, unseen.first_starts())
        if has_ripple(hypothesis):
            followed = unseen.following(hypothesis, theta)
            _, unseen = track(followed, hypothesis, theta, starts, order_known=True, phase_known=True)
            starts = settled_starts(unseen, hypothesis, theta, starts)
        shown = simulated_samples(unseen, hypothesis, theta, starts)
        gaps.append(channel_gaps(unseen.traces, unseen.floor, shown))
    return gaps[0], gaps[1]


def disagreeing(after: Gaps, before: Gaps | None = None) -> tuple[str, ...]:
    """Channels of held-out recordings that keep more than noise, whatever the fitted ones say.

    Args:
        before: where effects are named, the gaps without them: a tenth of their power may stay, since
            formulas and numbers that few recordings tell differ a little.
    """
    most = dict.fromkeys(after, CHANNEL_NOISES**2 - 1.0)
    for channel, gap in (before or {}).items():
        most[channel] = max(most[channel], (1.0 - SHUT_BY_LAW) * (gap.noises**2 - 1.0))
    return tuple(channel for channel, gap in after.items() if gap.noises**2 - 1.0 > most[channel])


def words_on(channels: tuple[str, ...], gaps: Gaps) -> str:
    """What to say where recordings that were held out disagree."""
    kept = ", ".join(f"{gaps[c].noises:.3g} times its noise in {c}" for c in channels)
    return (
        f"held-out recordings leave {kept}: something is missing, or a number is wrong, that the recordings "
        "fitted do not show; give those held out as recordings too, and hold others out"
    )
