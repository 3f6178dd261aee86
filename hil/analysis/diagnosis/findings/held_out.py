"""Recordings that no fit has seen: what the model leaves of them, and whether that is more than it may."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.gap import ChannelGap
from hil.analysis.diagnosis.findings.result import Verdict
from hil.analysis.diagnosis.thresholds import FAR_NOISES, MOMENT_S, VISIBLE
from hil.analysis.missing_effects import SLOW_NOISE, Series
from hil.core.channels import OUTPUTS
from hil.core.errors.wording import multiple

Array = npt.NDArray[np.float64]
Gaps = dict[str, ChannelGap]

_WHAT_TO_DO = (
    "something is missing, or a number is wrong, that the recordings fitted do not show; give those held out "
    "as recordings too, and hold others out"
)
_OR_ANGLES = (
    "a ripple's angle, integrated from a speed, walks off with that speed's noise (record the angle), or "
)


@dataclass(frozen=True)
class Event:
    """The moment at which a held-out recording is furthest off: rms over `MOMENT_S` in noise levels."""

    channel: str
    recording: str
    time_s: float
    noises: float


@dataclass(frozen=True)
class HeldOut:
    """Gaps with the model as it came and with the one given back, empty without recordings held out.

    `walks`: the model follows an angle that was not recorded.
    """

    before: Gaps
    after: Gaps
    event: Event | None
    walks: bool = False

    def open(self, verdict: Verdict) -> tuple[str, ...]:
        """Channels that keep more than noise, or where nothing is named, more than is proven to be noise."""
        most = SLOW_NOISE if verdict == "none" else VISIBLE
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
        if verdict == "none" and self.event is not None and self.event.noises > FAR_NOISES:
            e = self.event
            lines.append(
                f"held-out recording {e.recording} is off by {multiple(e.noises)} the noise in {e.channel} "
                f"at {e.time_s:.4g} s"
            )
        return f"{'; '.join(lines)}: {_OR_ANGLES if self.walks else ''}{_WHAT_TO_DO}" if lines else ""


def furthest(traces: Sequence[Series], noise: Array, simulated: Sequence[Array]) -> Event | None:
    """Where simulated channels (n x 3 each recording) are furthest off for a moment, in `noise` (3,)."""
    found = None
    for trace, values in zip(traces, simulated, strict=True):
        length = max(1, round(MOMENT_S / trace.dt))
        error = (trace.samples - values) / noise
        count = len(error) // length
        power = np.mean(error[: count * length].reshape(count, length, 3) ** 2, axis=1)
        for column in np.flatnonzero(trace.has).tolist():
            at = int(np.argmax(power[:, column]))
            noises = float(np.sqrt(power[at, column]))
            if found is None or noises > found.noises:
                found = Event(OUTPUTS[column], trace.name, (at + 0.5) * length * trace.dt, noises)
    return found
