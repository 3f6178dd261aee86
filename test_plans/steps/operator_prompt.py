"""`operator_prompt`: ask the operator to do something."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Step


class OperatorPrompt(Step):
    """Show a text and wait for the answer."""

    kind: ClassVar[str] = "operator_prompt"
    text: str = Field(min_length=1, max_length=1000, description="what the operator reads")

    def carry_out(self, conductor: Conductor) -> None:
        """Ask."""
        conductor.prompt(self.text)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - nobody knows
        """People take as long as they take: counted as none."""
        return Outlook(0.0, speed_m_s)
