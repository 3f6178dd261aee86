"""What people who share a bench tell each other: reservations, and notes for the next shift."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import AwareDatetime, Field, model_validator

from hil.api_schemas.api import BenchName, RunId, _Data

LONGEST = datetime.timedelta(days=31)
#: Of one bench, that are not over.
MOST_RESERVATIONS = 500
#: Moments that every database takes, in any zone.
_FIRST_YEAR, _LAST_YEAR = 2000, 2200
#: A line with something on it; lines with something on them.
_PRINTABLE, _PLAIN = r"[^\x00-\x1f\x7f-\x9f]", r"[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]"
_LINE = rf"^{_PRINTABLE}*[^\s\x00-\x1f\x7f-\x9f]{_PRINTABLE}*$"
_LINES = rf"^{_PLAIN}*[^\s\x00-\x1f\x7f-\x9f]{_PLAIN}*$"

Shift = Literal["early", "day", "late", "night"]


class ReservationWanted(_Data):
    """A bench wanted for oneself."""

    begins: AwareDatetime = Field(description="with its zone")
    ends: AwareDatetime = Field(description="with its zone, at most 31 days later")
    reason: str = Field(min_length=1, max_length=200, pattern=_LINE)

    @model_validator(mode="after")
    def _possible(self) -> ReservationWanted:
        if not all(_FIRST_YEAR <= one.year < _LAST_YEAR for one in (self.begins, self.ends)):
            raise ValueError(f"years are from {_FIRST_YEAR} to {_LAST_YEAR - 1}")
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
