"""`hold_speed`: the dynos bring the vehicle to a speed and hold it."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Seconds, Step


class HoldSpeed(Step):
    """Ramp to a vehicle speed, then hold it for a time."""

    kind: ClassVar[str] = "hold_speed"
    speed_km_h: float = Field(ge=-100, le=400, description="vehicle speed, km/h, from -100 to 400")
    hold_s: Seconds = Field(alias="duration_s", description="time at the speed, after the ramp to it, s")

    def execute(self, conductor: Conductor) -> None:
        """Ramp and hold."""
        conductor.hold_speed(self.speed_km_h / 3.6, self.hold_s)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        """The dynos' ramp and the time at the speed."""
        target = self.speed_km_h / 3.6
        return Outlook(pace.ramp_s(speed_m_s, target) + self.hold_s, target)
