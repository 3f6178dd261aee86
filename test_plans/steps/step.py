"""`step`: from one torque to another at once."""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import Field, model_validator

from test_plans import stimuli
from test_plans.conductor import Array
from test_plans.steps._excitation import Excitation
from test_plans.steps._step import Duration, Name, Seconds, Torque


class TorqueStep(Excitation):
    """A step of torque from one constant level to another."""

    kind: ClassVar[str] = "step"
    segment: Name = Field(description="name of the recorded segment")
    from_nm: Torque = Field(description="torque before the step, N m")
    to_nm: Torque = Field(description="torque after the step, N m")
    before_s: Seconds = Field(description="time before the step, s")
    after_s: Duration = Field(description="time after the step, s, at least 0.1")

    @model_validator(mode="after")
    def _is_a_step(self) -> Self:
        if self.from_nm == self.to_nm:
            raise ValueError("from_nm and to_nm are the same: that is no step")
        return self

    def samples(self, sample_time_s: float, play: int) -> Array:  # noqa: ARG002 - one play
        """`from_nm`, then `to_nm`."""
        return stimuli.step(self.from_nm, self.to_nm, self.before_s, self.after_s, sample_time_s)

    @property
    def play_s(self) -> float:
        """Before and after."""
        return self.before_s + self.after_s

    @property
    def mean_nm(self) -> float:
        """Weighted by time."""
        return (self.from_nm * self.before_s + self.to_nm * self.after_s) / self.play_s

    @property
    def step_s(self) -> float:
        """When the torque changes."""
        return self.before_s

    @property
    def references_nm(self) -> tuple[float, float]:
        """The two torques."""
        return self.from_nm, self.to_nm
