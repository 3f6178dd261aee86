"""What people who share a bench tell each other: reservations, and notes for the next shift."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import AwareDatetime, BaseModel, ConfigDict, Field, model_validator

from hil.api_schemas.api import BenchName, RunId

LONGEST = datetime.timedelta(days=31)
#: Of one bench, that are not over.
MOST_RESERVATIONS = 500
_PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f]+$"
#: Lines of people: no control characters but the end of a line and a tab.
_LINES = r"^[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]*$"

Shift = Literal["early", "day", "late", "night"]


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid")


class ReservationWanted(_Data):
    """A bench wanted for oneself."""

    begins: AwareDatetime = Field(description="with its zone")
    ends: AwareDatetime = Field(description="with its zone, at most 31 days later")
    reason: str = Field(min_length=1, max_length=200, pattern=_PRINTABLE)

    @model_validator(mode="after")
    def _possible(self) -> ReservationWanted:
        if not datetime.timedelta(0) < self.ends - self.begins <= LONGEST:
            raise ValueError("ends must be later than begins, by 31 days at most")
        return self


class HandoverWanted(_Data):
    """A note for whoever has the bench next."""

    day: datetime.date
    shift: Shift
    text: Annotated[str, Field(min_length=1, max_length=4000, pattern=_LINES)]


class HandoverData(_Data):
    """A note of a shift for the next."""

    id: RunId
    bench: BenchName
    day: datetime.date
    shift: Shift
    text: str
    who: str
    at: datetime.datetime
