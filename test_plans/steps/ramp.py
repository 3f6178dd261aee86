"""`ramp`: from one torque to another along a straight line."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from test_plans import stimuli
from test_plans.conductor import Array
from test_plans.steps._excitation import Excitation
from test_plans.steps._step import LONGEST_S, Seconds, Torque


class Ramp(Excitation):
    """A torque that changes linearly; metrics count from the beginning of the ramp."""

    kind: ClassVar[str] = "ramp"
    from_nm: Torque = Field(description="torque at the beginning, N m")
    to_nm: Torque = Field(description="torque at the end, N m")
    line_s: Annotated[float, Field(ge=0.01, le=LONGEST_S)] = Field(
        alias="duration_s", description="duration of the ramp itself, s, at least 0.01"
    )
    before_s: Seconds = Field(default=0.0, description="time at from_nm before the ramp, s")
    after_s: Seconds = Field(default=0.0, description="time at to_nm after the ramp, s")

    def samples(self, sample_time_s: float, play: int) -> Array:  # noqa: ARG002 - one play
        """Constant, line, constant."""
        return stimuli.ramp(self.from_nm, self.to_nm, self.before_s, self.line_s, self.after_s, sample_time_s)

    @property
    def play_s(self) -> float:
        """All three parts."""
        return self.before_s + self.line_s + self.after_s

    @property
    def mean_nm(self) -> float:
        """Weighted by time."""
        middle = 0.5 * (self.from_nm + self.to_nm) * self.line_s
        return (self.from_nm * self.before_s + middle + self.to_nm * self.after_s) / self.play_s

    @property
    def step_s(self) -> float:
        """When the ramp begins."""
        return self.before_s

    @property
    def rise_s(self) -> float:
        """The line's duration."""
        return self.line_s

    @property
    def references_nm(self) -> tuple[float, float]:
        """The torques at both ends."""
        return self.from_nm, self.to_nm
