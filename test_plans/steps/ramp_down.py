"""`ramp_down`: torque and speed to zero."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Duration, Step


class RampDown(Step):
    """Ramp to rest within a time."""

    kind: ClassVar[str] = "ramp_down"
    down_s: Duration = Field(alias="duration_s", description="duration of the ramp to rest, s, at least 0.1")

    def execute(self, conductor: Conductor) -> None:
        """Ramp down."""
        conductor.ramp_down(self.down_s)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - time is given
        """The time given, then standstill."""
        return Outlook(self.down_s, 0.0)
