"""Extremes of a channel after the step: peak, trough and magnitude."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import PlannedSegment
from test_plans.metrics._metric import ChannelName, Limits
from test_plans.metrics._transient import refuse_reversal
from test_plans.metrics._window import WindowMetric


class Extreme(WindowMetric):
    """An extreme of the window; the sample at its step, which is the value before it, is left out."""

    @property
    def _at(self) -> str:
        """What the left out sample lies at, in words."""
        return "the step" if self.since == "step" else "that change"

    def extremes(self, recording: Recording, segment: Segment) -> tuple[float, float]:
        """Smallest and largest value."""
        time, values = self.samples(recording, segment)
        inside = time > self.origin_s(segment) + 0.5 * recording.sample_time_s
        inside |= self.from_s > 0 or not np.any(inside)
        return float(np.min(values[inside])), float(np.max(values[inside]))


class Peak(Extreme):
    """Value of a channel that lies farthest in the step's direction."""

    name: ClassVar[str] = "peak"
    follows_step: ClassVar[bool] = True

    @property
    def definition(self) -> str:
        """The extreme in the step's direction."""
        return (
            f"Value of {self.subject} farthest in the step's direction, {self.window} (the sample at "
            "the step left out): the largest after an upward step, the smallest after a downward one."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The extreme sample."""
        refuse_reversal(recording, segment)
        lowest, highest = self.extremes(recording, segment)
        return lowest if is_downward(segment) else highest

    def objection_to_limits(self, segment: PlannedSegment, limits: Limits) -> str:
        """An upper limit on the peak of a downward step: the step never goes there."""
        if not is_downward(segment):
            return ""
        if limits.below:
            return "the step goes down, so its peak is its smallest value: compare 'magnitude' instead"
        if limits.upper is not None:
            return (
                "the step goes down, so its peak is its smallest value, which an upper limit does not bound: "
                "give 'lower', or limit the metric 'trough' or 'magnitude'"
            )
        return ""


class PeakShaftTorque(Peak):
    """Peak of T_s after the step."""

    name: ClassVar[str] = "peak_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"


class Trough(Extreme):
    """Value of a channel that lies farthest against the step's direction."""

    name: ClassVar[str] = "trough"
    follows_step: ClassVar[bool] = True

    @property
    def definition(self) -> str:
        """The extreme against the step's direction."""
        return (
            f"Value of {self.subject} farthest against the step's direction, {self.window} (the sample at "
            "the step left out): the smallest after an upward step, the largest after a downward one."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The extreme sample."""
        refuse_reversal(recording, segment)
        lowest, highest = self.extremes(recording, segment)
        return highest if is_downward(segment) else lowest

    def objection(self, segment: PlannedSegment) -> str:
        """No step that it could lie against."""
        if segment.reference_before == segment.reference_after:
            return f"a {segment.kind} has no step that a trough lies against: limit 'magnitude'"
        return super().objection(segment)

    def objection_to_limits(self, segment: PlannedSegment, limits: Limits) -> str:
        """A limit on the side to which the trough does not go."""
        if limits.below:
            return "a trough is not compared with 'below': compare 'magnitude' instead"
        if is_downward(segment) and limits.lower is not None and limits.upper is None:
            return "the step goes down, so its trough is its largest value: give 'upper', or limit 'peak'"
        if not is_downward(segment) and limits.upper is not None and limits.lower is None:
            return "the step goes up, so its trough is its smallest value: give 'lower', or limit 'peak'"
        return ""


class Magnitude(Extreme):
    """Largest absolute value of a channel."""

    name: ClassVar[str] = "magnitude"
    never_negative: ClassVar[bool] = True

    @property
    def definition(self) -> str:
        """The largest absolute value."""
        return f"Largest absolute value of {self.subject} {self.window} (the sample at {self._at} left out)."

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The larger of both extremes without its sign."""
        lowest, highest = self.extremes(recording, segment)
        return max(-lowest, highest)


def is_downward(segment: Segment | PlannedSegment) -> bool:
    """Whether the step of a segment goes down; without a step it does not."""
    return segment.reference_after < segment.reference_before
