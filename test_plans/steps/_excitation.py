"""Steps that play samples of torque: what they have in common."""

from __future__ import annotations

from abc import abstractmethod
from typing import Literal, Self

from pydantic import Field

from test_plans.conductor import Array, Conductor, PlannedSegment, Quantity
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import SAMPLE_TIME_S, Name, Step

NYQUIST_HZ = 0.5 / SAMPLE_TIME_S


class Excitation(Step):
    """Plays `samples` once or several times; each time is a segment of its own."""

    segment: Name | None = Field(
        default=None, description="name of the recorded segment; without it the step is not evaluated"
    )
    quantity: Quantity = Field(description="driving_torque (wheel side) or motor_torque")
    load: Literal["vehicle", "speed"] = Field(
        default="vehicle",
        description="load by the dynos: vehicle simulates the vehicle, speed holds the speed",
    )

    @abstractmethod
    def samples(self, sample_time_s: float, play: int) -> Array:
        """Torque in N m, one value a sample; `play` counts from 0."""

    @property
    @abstractmethod
    def play_s(self) -> float:
        """Duration of one play in seconds."""

    @property
    @abstractmethod
    def mean_nm(self) -> float:
        """Mean torque of one play."""

    @property
    def needs_controller(self) -> bool:
        """Driving torque is what a controller makes of a request."""
        return self.quantity == "driving_torque"

    @property
    def plays(self) -> int:
        """How often `samples` are played."""
        return 1

    @property
    def step_s(self) -> float:
        """Offset of the step (or of what else metrics count from) from the first sample."""
        return 0.0

    @property
    def first_change_s(self) -> float | None:
        """Offset of the first change of torque, where that is not the step's; else None."""
        return None

    @property
    def rise_s(self) -> float:
        """How long the step takes."""
        return 0.0

    @property
    def references_nm(self) -> tuple[float, float]:
        """Torque before and after the step."""
        return self.mean_nm, self.mean_nm

    def segments(self) -> tuple[PlannedSegment, ...]:
        """One segment a play; of several plays the ids end in _1, _2, ..."""
        if self.segment is None:
            return ()
        names = [self.segment] if self.plays == 1 else [f"{self.segment}_{n + 1}" for n in range(self.plays)]
        before, after = self.references_nm
        return tuple(
            PlannedSegment(
                name,
                self.kind,
                self.step_s,
                before,
                after,
                self.quantity,
                self.play_s,
                self.rise_s,
                self.first_change_s,
            )
            for name in names
        )

    def execute(self, conductor: Conductor) -> None:
        """Release the dynos if the load is the vehicle, then play."""
        if self.load == "vehicle":
            conductor.release_vehicle()
        segments = self.segments() or (None,) * self.plays
        for play, segment in enumerate(segments):
            conductor.play(self.quantity, self.samples(conductor.sample_time_s, play), segment)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        """Durations add up; a released vehicle gains speed by the mean torque."""
        duration = self.plays * self.play_s
        if self.load == "vehicle":
            speed_m_s += pace.acceleration_m_s2(self.quantity, self.mean_nm) * duration
        return Outlook(duration, speed_m_s)

    def numbered(self, number: int) -> Self:
        """The same step with a numbered segment."""
        if self.segment is None:
            return self
        return self.model_copy(update={"segment": f"{self.segment}_{number}"})
