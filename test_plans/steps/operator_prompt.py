"""`operator_prompt`: ask the operator to do something."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from test_plans.conductor import PROMPT_TIMEOUT_S, Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Step

#: Name of a file in the plan's own folder.
PICTURE = r"[A-Za-z0-9][A-Za-z0-9_-]{0,57}\.(png|jpg|jpeg|svg)"


class OperatorPrompt(Step):
    """Show a text to the operator and wait for the answer, up to a time limit."""

    kind: ClassVar[str] = "operator_prompt"
    text: str = Field(min_length=1, max_length=1000, description="message to the operator")
    timeout_s: float = Field(
        default=PROMPT_TIMEOUT_S,
        gt=0,
        le=24 * 3600,
        description="time for an answer, s; without one the run ends; default: 600",
    )

    picture: str = Field(
        default="",
        pattern=rf"^({PICTURE})?$",
        description="picture beside the plan (PNG, JPEG or SVG) that the service's page shows with the text",
    )

    def execute(self, conductor: Conductor) -> None:
        """Ask."""
        conductor.prompt(self.text, self.timeout_s, self.picture)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - no one knows
        """People take as long as they take: counted as none."""
        return Outlook(0.0, speed_m_s)
