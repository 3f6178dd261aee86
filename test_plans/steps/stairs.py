"""`stairs`: one torque after another, each held for the same time."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans import stimuli
from test_plans.conductor import Array
from test_plans.steps._excitation import Excitation
from test_plans.steps._step import Duration, Torque


class Stairs(Excitation):
    """Several levels of torque; metrics count from the last step and compare its two levels."""

    kind: ClassVar[str] = "stairs"
    levels_nm: tuple[Torque, ...] = Field(
        strict=False, min_length=2, max_length=1000, description="the levels in order, N m: a list"
    )
    hold_s: Duration = Field(description="time at each level, s, at least 0.1")

    def samples(self, sample_time_s: float, play: int) -> Array:  # noqa: ARG002 - one play
        """Level by level."""
        return stimuli.stairs(self.levels_nm, self.hold_s, sample_time_s)

    @property
    def play_s(self) -> float:
        """All levels."""
        return self.hold_s * len(self.levels_nm)

    @property
    def mean_nm(self) -> float:
        """Mean of the levels."""
        return sum(self.levels_nm) / len(self.levels_nm)

    @property
    def step_s(self) -> float:
        """When the last level begins."""
        return self.hold_s * (len(self.levels_nm) - 1)

    @property
    def references_nm(self) -> tuple[float, float]:
        """The last two levels."""
        return self.levels_nm[-2], self.levels_nm[-1]
