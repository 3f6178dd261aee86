"""`set_slip`: the tyre slip that the dynos' vehicle has from now on."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Step

LARGEST_PERCENT = 50.0


class SetSlip(Step):
    """Write a slip rate to the dynos' vehicle model and read it back; it holds until another is written."""

    kind: ClassVar[str] = "set_slip"
    slip_percent: float = Field(
        ge=0,
        le=LARGEST_PERCENT,
        description="slip between wheels and vehicle, %, from 0 to 50",
    )

    def execute(self, conductor: Conductor) -> None:
        """Write it."""
        conductor.set_slip(self.slip_percent / 100.0)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - a few milliseconds
        """Next to no time."""
        return Outlook(0.0, speed_m_s)
