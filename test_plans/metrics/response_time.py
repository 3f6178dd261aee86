"""Response time and arrival: how soon, and how exactly, a channel follows a step."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import PlannedSegment
from test_plans.metrics import _reference
from test_plans.metrics._metric import ChannelName, NotReachedError, NoValueError
from test_plans.metrics._window import WindowMetric


class _Following(WindowMetric):
    """A metric of how a channel follows the step's own quantity."""

    def objection(self, segment: PlannedSegment) -> str:
        """No step, or one of another torque than the channel's."""
        return (
            _reference.no_step(segment)
            or _reference.not_comparable(segment, self.channel)
            or super().objection(segment)
        )


class ResponseTime(_Following):
    """Time from the step until a channel first reaches a share of the step's size."""

    name: ClassVar[str] = "response_time"
    share_percent: float = Field(default=90.0, gt=0, lt=100, description="of the step's size, %")

    @property
    def unit(self) -> str:
        """Seconds."""
        return "s"

    @property
    def definition(self) -> str:
        """The first crossing."""
        return (
            f"Time from the step until {self.subject} first reaches {self.share_percent:g} % of the step's "
            f"size, linear between samples, {self.window}."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Seconds; NotReachedError where the channel does not get there."""
        size = segment.reference_after - segment.reference_before
        if size == 0:
            raise NoValueError("the segment has no step: before and after are the same")
        time, values = self.samples(recording, segment)
        progress = (values - segment.reference_before) / size
        share = self.share_percent / 100
        reached = np.flatnonzero(progress >= share)
        if not reached.size:
            raise NotReachedError(
                f"{self.channel} does not reach {self.share_percent:g} % of the step: at most "
                f"{100 * float(np.max(progress)):.3g} % within {time[-1] - segment.step_s:.3g} s"
            )
        first = int(reached[0])
        if first == 0:
            return max(0.0, float(time[0] - segment.step_s))
        part = (share - progress[first - 1]) / (progress[first] - progress[first - 1])
        return float(time[first - 1] + part * (time[first] - time[first - 1]) - segment.step_s)


class ResponseTimeShaftTorque(ResponseTime):
    """Response time of T_s."""

    name: ClassVar[str] = "response_time_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"


class Arrival(_Following):
    """How far the end of a response lies from what was asked, in percent of the step's size."""

    name: ClassVar[str] = "arrival"
    mean_s: float = Field(default=2.0, gt=0, description="length of the mean at the window's end, s")

    @property
    def unit(self) -> str:
        """Percent."""
        return "%"

    @property
    def definition(self) -> str:
        """Mean at the end minus the reference."""
        return (
            f"Mean of {self.subject} over the last {self.mean_s:g} s of the window, {self.window}, minus the "
            "value after the step, in percent of the step's size: positive beyond it, negative short of it."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Percent of the step, in its direction."""
        size = segment.reference_after - segment.reference_before
        if size == 0:
            raise NoValueError("the segment has no step: before and after are the same")
        time, values = self.samples(recording, segment)
        last = values[time > time[-1] - self.mean_s]
        return 100 * (float(np.mean(last)) - segment.reference_after) / size


class ArrivalShaftTorque(Arrival):
    """Arrival of T_s."""

    name: ClassVar[str] = "arrival_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"
