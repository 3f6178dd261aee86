"""`stairs`: one torque after another, each held for the same time."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans import stimuli
from test_plans.conductor import Array
from test_plans.steps._excitation import Excitation
from test_plans.steps._step import Duration, Torque


class Stairs(Excitation):
    """Several levels of torque; the step is the change to the last level.

    Metrics count from that step and compare its two levels; with `since: first_change` they judge them all.
    """

    kind: ClassVar[str] = "stairs"
    levels_nm: tuple[Torque, ...] = Field(
        strict=False, min_length=2, max_length=1000, description="the levels in order, N m: a list"
    )
    hold_s: Duration = Field(description="time at each level, s, at least 0.1")
    first_s: Duration | None = Field(default=None, description="time at the first level instead, s")
    last_s: Duration | None = Field(default=None, description="time at the last level instead, s")

    def samples(self, sample_time_s: float, play: int) -> Array:  # noqa: ARG002 - one play
        """Level by level."""
        return stimuli.stairs(self.levels_nm, self._times_s, sample_time_s)

    @property
    def play_s(self) -> float:
        """All levels."""
        return sum(self._times_s)

    @property
    def mean_nm(self) -> float:
        """Mean of the levels, weighted by time."""
        parts = zip(self.levels_nm, self._times_s, strict=True)
        return sum(level * time_s for level, time_s in parts) / self.play_s

    @property
    def step_s(self) -> float:
        """When the last level begins."""
        return sum(self._times_s[:-1])

    @property
    def first_change_s(self) -> float | None:
        """When the first level ends that is followed by another torque; None where that is the step's."""
        first = self.levels_nm[0]
        changes = (place for place, level in enumerate(self.levels_nm) if level != first)
        place = next(changes, len(self.levels_nm) - 1)
        return None if place == len(self.levels_nm) - 1 else sum(self._times_s[:place])

    @property
    def references_nm(self) -> tuple[float, float]:
        """The last two levels."""
        return self.levels_nm[-2], self.levels_nm[-1]

    @property
    def _times_s(self) -> tuple[float, ...]:
        """Of each level: a driver who changes their mind holds the middle ones shortly."""
        between = (self.hold_s,) * (len(self.levels_nm) - 2)
        return self.first_s or self.hold_s, *between, self.last_s or self.hold_s
