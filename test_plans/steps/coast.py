"""`coast`: no torque for a time."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Seconds, Step


class Coast(Step):
    """Zero torque for a time."""

    kind: ClassVar[str] = "coast"
    coast_s: Seconds = Field(alias="duration_s", description="time without torque, s")

    def execute(self, conductor: Conductor) -> None:
        """Coast."""
        conductor.coast(self.coast_s)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - time is given
        """The time given; running resistance is left out."""
        return Outlook(self.coast_s, speed_m_s)
