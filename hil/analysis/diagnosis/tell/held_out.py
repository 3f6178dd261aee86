"""Recordings that no fit has seen: what the model leaves of them, and whether that is more than it may."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.gap import ChannelGap, channel_gaps
from hil.analysis.diagnosis.data.sanity import Examined
from hil.analysis.diagnosis.data.thresholds import SLOW_UNPROVEN
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.fit.simulated import settled_starts, simulated_samples
from hil.analysis.diagnosis.search.alignment import has_ripple
from hil.analysis.diagnosis.search.search import Found
from hil.analysis.diagnosis.search.tracking import track
from hil.analysis.diagnosis.tell.result import Verdict
from hil.analysis.diagnosis.tell.thresholds import CHANNEL_NOISES, EVENT_NOISES, EVENT_S
from hil.core.channels import OUTPUTS
from hil.core.errors.wording import multiple

Array = npt.NDArray[np.float64]
Gaps = dict[str, ChannelGap]

_WHAT_TO_DO = (
    "something is missing, or a number is wrong, that the recordings fitted do not show; give those held out "
    "as recordings too, and hold others out"
)


@dataclass(frozen=True)
class Event:
    """The moment at which a held-out recording is furthest off: rms over `EVENT_S` in noise levels."""

    channel: str
    recording: str
    time_s: float
    noises: float


@dataclass(frozen=True)
class HeldOut:
    """Gaps with the model as it came and with the one given back, empty without recordings held out."""

    before: Gaps
    after: Gaps
    event: Event | None

    def open(self, verdict: Verdict) -> tuple[str, ...]:
        """Channels that keep more than noise, or where nothing is named, more than is proven to be noise."""
        most = SLOW_UNPROVEN if verdict == "none" else CHANNEL_NOISES
        return tuple(channel for channel, gap in self.after.items() if gap.noises > most)

    def words(self, verdict: Verdict) -> str:
        """What to say where they disagree, nothing where they do not, or nothing explains the fitted either.

        A moment that is far off beside hours that are not counts where nothing is named as missing; beside
        a name, whose law may differ a little, only what counts in the whole.
        """
        if verdict == "unknown":
            return ""
        lines = []
        if channels := self.open(verdict):
            kept = ", ".join(f"{multiple(self.after[c].noises)} its noise in {c}" for c in channels)
            lines.append(f"held-out recordings leave {kept}")
        if verdict == "none" and self.event is not None and self.event.noises > EVENT_NOISES:
            e = self.event
            lines.append(
                f"held-out recording {e.recording} is off by {multiple(e.noises)} the noise in {e.channel} "
                f"at {e.time_s:.4g} s"
            )
        return f"{'; '.join(lines)}: {_WHAT_TO_DO}" if lines else ""


def held_out(problem: Problem, holdout: Examined, found: Found, kept: Fit) -> HeldOut:
    """What the model as it came and `kept` leave of the recordings held out.

    Only initial values are fitted to them and, with a ripple, the drift of the angle that it follows. A
    sensor is as noisy as it was in the recordings fitted: blows of a play reach where noise is read.
    """
    if not holdout.traces:
        return HeldOut({}, {}, None)
    noise = np.fmin(holdout.noise, np.where(np.isfinite(problem.noise), problem.floor, holdout.noise))
    floor = noise * found.evidence.colouring(found.best)
    weighed = np.where(np.isfinite(problem.noise), problem.noise, noise)  # rounding included
    unseen = problem_of(holdout.traces, weighed, problem.gear_ratio, floor=floor, functions=problem.functions)
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
        gaps.append(channel_gaps(unseen.traces, floor, shown))
    return HeldOut(gaps[0], gaps[1], furthest(unseen.traces, np.fmax(floor, weighed), shown))


def furthest(traces: Sequence[Trace], noise: Array, simulated: Sequence[Array]) -> Event | None:
    """Where simulated channels (n x 3 each recording) are furthest off for a moment, in `noise` (3,)."""
    found = None
    for trace, values in zip(traces, simulated, strict=True):
        length = max(1, round(EVENT_S / trace.dt))
        error = np.where(trace.judged_samples[:, None], (trace.samples - values) / noise, 0.0)
        count = len(error) // length
        power = np.mean(error[: count * length].reshape(count, length, 3) ** 2, axis=1)
        for column in np.flatnonzero(trace.has).tolist():
            at = int(np.argmax(power[:, column]))
            noises = float(np.sqrt(power[at, column]))
            if found is None or noises > found.noises:
                found = Event(OUTPUTS[column], trace.name, (at + 0.5) * length * trace.dt, noises)
    return found
