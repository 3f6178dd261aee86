"""Dead time of a rigid axle: its shaft torque shows the request late by whole samples, and nothing between.

With no spring between, shaft torque jumps with every sample of the request. The error then jumps with the
dead time wherever that crosses a sample: no slope leads across, so descents stay within a sample and the
neighbouring ones are tried. A lag lets no jump through, but a bend: with one a descent goes where it likes,
and where it ends at a bend it begins again on either side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.thresholds import (
    AT_BEND,
    BESIDE_BEND,
    COINCIDENCE,
    EDGE,
    JUST,
    LEAPS,
    TOLERANCE,
)
from hil.core.channels import OUTPUTS

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class DelayBySamples:
    """Where the dead time of a rigid hypothesis stands among its coordinates; `dt` in s is of a sample."""

    hypothesis: Hypothesis
    index: int
    skew: int | None  # the coordinate of the delay of the shaft torque's own channel
    dt: float

    @property
    def lags(self) -> bool:
        """Whether a low-pass lies between the request and what is read of the shaft torque."""
        uses = (*self.hypothesis.base.effects, *self.hypothesis.terms)
        return any(
            use.id == "actuator_lag" or (use.id == "sensor_lag" and use.values["channel"] == OUTPUTS[2])
            for use in uses
        )

    def within(self, theta: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
        """Bounds of a descent from `theta`: those given, and of the sample that its dead time lies in."""
        if self.lags:
            return lower, upper
        sample = np.floor(self._delay(theta) / self.dt + 1e-9)
        ends = [self._at(theta, (sample + share) * self.dt) for share in (EDGE, 1.0 - EDGE)]
        lower, upper = lower.copy(), upper.copy()
        low, high = max(lower[self.index], ends[0]), min(upper[self.index], ends[1])
        if low < high:
            lower[self.index], upper[self.index] = low, high
        return lower, upper

    def leaps(self, theta: Array, lower: Array, upper: Array) -> list[Array]:
        """`theta` with the dead time in other samples; with the channel's delay making up for it as well.

        A mere correction of the model's dead time stays within its calibration tolerance: more is a finding,
        unless all numbers are free.
        """
        found = []
        least, most = float(lower[self.index]), float(upper[self.index])
        if np.isfinite(self.hypothesis.coordinates()[self.index].prior) and not self.hypothesis.far:
            least, most = max(least, -TOLERANCE), min(most, TOLERANCE)
        delay = self._delay(theta)
        sample = np.floor(delay / self.dt + 1e-9)
        for more in LEAPS:
            low = self._at(theta, (sample + more + EDGE) * self.dt)
            high = self._at(theta, (sample + more + 1.0 - EDGE) * self.dt)
            if low > most or high < least:
                continue
            other = theta.copy()
            middle = min(max(self._at(theta, (sample + more + 0.5) * self.dt), low), high)
            other[self.index] = min(max(middle, least), most)
            found.append(other)
            if self.skew is not None:
                late = other.copy()
                late[self.skew] -= more * self.dt
                if lower[self.skew] <= late[self.skew] <= upper[self.skew]:
                    found.append(late)
        return found

    def beside_bend(self, theta: Array, lower: Array, upper: Array) -> list[Array]:
        """`theta` with the dead time a little shorter and longer, where it ended at a whole sample."""
        samples = self._delay(theta) / self.dt
        if not self.lags or abs(samples - round(samples)) > AT_BEND:
            return []
        found = []
        for more in (-BESIDE_BEND, BESIDE_BEND):
            other = theta.copy()
            other[self.index] = self._at(theta, (samples + more) * self.dt)
            if lower[self.index] <= other[self.index] <= upper[self.index]:
                found.append(other)
        return found

    def coincidence(self, theta: Array) -> float:
        """Price in squared errors of a channel that is late by just a sample: dead time is by nature."""
        if self.skew is None:
            return 0.0
        late = float(theta[self.skew]) / self.dt
        return COINCIDENCE if late > 0.5 and abs(late - round(late)) < JUST else 0.0

    def _delay(self, theta: Array) -> float:
        model = self.hypothesis.model(theta)
        extra = [float(use.values["extra_delay_s"]) for use in model.effects if use.id == "dead_time"]
        return model.parameters["torque_delay"] + sum(extra)

    def _at(self, theta: Array, delay: float) -> float:
        """The coordinate that makes the dead time `delay` in s."""
        c = self.hypothesis.coordinates()[self.index]
        if c.scale == "linear":
            return float(theta[self.index] + delay - self._delay(theta))
        own = self.hypothesis.base.parameters[c.name] * float(np.exp(theta[self.index]))
        return float(theta[self.index] + np.log(max(own + delay - self._delay(theta), 1e-9) / own))


def delay_by_samples(hypothesis: Hypothesis, dt: float) -> DelayBySamples | None:
    """The free dead time of a rigid hypothesis; None for other models, and where it is not free."""
    if hypothesis.base.kind != "rigid":
        return None
    index, skew = None, None
    for i, c in enumerate(hypothesis.coordinates()):
        if c.name in ("torque_delay", "extra_delay_s"):
            index = i
        elif c.name == "delay_s" and hypothesis.terms[c.term].values["channel"] == OUTPUTS[2]:
            skew = i
    return None if index is None else DelayBySamples(hypothesis, index, skew, dt)
