"""Overshoot: how far a response goes beyond the reference, in the step's direction."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import PlannedSegment
from test_plans.metrics import _samples
from test_plans.metrics._metric import ChannelName
from test_plans.metrics._transient import refuse_reversal
from test_plans.metrics.peak import Extreme, is_downward


class Overshoot(Extreme):
    """How far the peak lies beyond the reference in the step's direction, not below zero."""

    name: ClassVar[str] = "overshoot"
    never_negative: ClassVar[bool] = True
    follows_step: ClassVar[bool] = True
    reference: float | None = Field(
        default=None,
        description="reference value of the channel, in its unit; default: the step's value after",
    )

    @property
    def definition(self) -> str:
        """Distance from the reference to the peak."""
        return (
            f"How far {self.subject} goes beyond the reference in the step's direction, upwards or "
            f"downwards, {self.window}; not below 0. Reference: {self._reference_in_words}."
        )

    @property
    def _reference_in_words(self) -> str:
        return "value after the step" if self.reference is None else f"{self.reference:g} {super().unit}"

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The excess in the channel's unit."""
        refuse_reversal(recording, segment)
        lowest, highest = self.extremes(recording, segment)
        reference = _samples.reference(segment, self.reference)
        return max(0.0, reference - lowest if is_downward(segment) else highest - reference)

    def objection(self, segment: PlannedSegment) -> str:
        """No step, or one of another torque than the channel's."""
        if self.reference is None:
            objection = _samples.no_step(segment, "reference") or _samples.not_comparable(
                segment, self.channel, "reference"
            )
            if objection:
                return objection
        return super().objection(segment)


class OvershootShaftTorque(Overshoot):
    """Overshoot of T_s over the requested driving torque."""

    name: ClassVar[str] = "overshoot_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"


class OvershootPercent(Overshoot):
    """Overshoot in percent of the step's size."""

    name: ClassVar[str] = "overshoot_percent"
    step_size: float | None = Field(
        default=None, gt=0, description="value of 100 %, in the channel's unit; default: the step's magnitude"
    )

    @property
    def unit(self) -> str:
        """Percent."""
        return "%"

    @property
    def definition(self) -> str:
        """Overshoot over step size."""
        size = "the step's size" if self.step_size is None else f"{self.step_size:g}"
        return f"{super().definition} In percent of {size}."

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The excess in percent."""
        size = _samples.step_size(segment, self.step_size)
        return 100 * super().compute(recording, segment) / size

    def objection(self, segment: PlannedSegment) -> str:
        """Also when the step's size is not the channel's."""
        if self.step_size is None:
            objection = _samples.no_step(segment, "step_size") or _samples.not_comparable(
                segment, self.channel, "step_size"
            )
            if objection:
                return objection
        return super().objection(segment)


class OvershootPercentShaftTorque(OvershootPercent):
    """Overshoot of T_s in percent of the step of driving torque."""

    name: ClassVar[str] = "overshoot_percent_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"
