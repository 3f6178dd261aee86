"""A plan as somebody writes it: checked before it is given."""

from __future__ import annotations

from pydantic import Field

from hil.api_schemas.api import PlanData, PlanName, _Data

MOST_CHARACTERS = 200_000


class PlanCheckWanted(_Data):
    """The text of a plan (YAML), and the name that it is to be given."""

    name: PlanName
    text: str = Field(max_length=MOST_CHARACTERS)


class PlanMistake(_Data):
    """A mistake, and what to do."""

    line: int | None = Field(description="from 1; null of what is on no line")
    key: str = Field(description="where on the line; '' if no key is meant")
    text: str


class PlanCheck(_Data):
    """All mistakes of a plan; without one, what it says."""

    mistakes: list[PlanMistake]
    plan: PlanData | None = None
