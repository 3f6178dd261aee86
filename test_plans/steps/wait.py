"""`wait`: leave everything as it is for a time."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Seconds, Step


class Wait(Step):
    """Wait for a time."""

    kind: ClassVar[str] = "wait"
    wait_s: Seconds = Field(alias="duration_s", description="time to wait, s")

    def execute(self, conductor: Conductor) -> None:
        """Wait."""
        conductor.wait(self.wait_s)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - time is given
        """The time given."""
        return Outlook(self.wait_s, speed_m_s)
