"""What people who share a bench tell each other: reservations, and notes for the next shift."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, AwareDatetime, Field, model_validator

from hil.api_schemas.api import BenchName, RunId, _Data

LONGEST = datetime.timedelta(days=31)
#: Of one bench, that are not over.
MOST_RESERVATIONS = 500
#: What is wanted is of now: a date far from it is a slip of the finger.
_BEFORE, _AHEAD = datetime.timedelta(days=1), datetime.timedelta(days=366)
#: No place on earth has a date further from that of UTC.
_ZONE = datetime.timedelta(hours=14)
#: A line with something on it; lines with something on them.
_PRINTABLE, _PLAIN = r"[^\x00-\x1f\x7f-\x9f]", r"[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]"
_LINE = rf"^{_PRINTABLE}*[^\s\x00-\x1f\x7f-\x9f]{_PRINTABLE}*$"
_LINES = rf"^{_PLAIN}*[^\s\x00-\x1f\x7f-\x9f]{_PLAIN}*$"

Shift = Literal["early", "day", "late", "night"]


def _near(at: datetime.datetime) -> datetime.datetime:
    now = datetime.datetime.now(datetime.UTC)
    if at < now - _BEFORE:
        raise ValueError("must not be more than a day ago")
    if at > now + _AHEAD:
        raise ValueError("must not be more than a year ahead")
    return at


def _near_day(day: datetime.date) -> datetime.date:
    now = datetime.datetime.now(datetime.UTC)
    if day < (now - _ZONE - _BEFORE).date():
        raise ValueError("must not be before yesterday")
    if day > (now + _ZONE + _AHEAD).date():
        raise ValueError("must not be more than a year ahead")
    return day


_Near = Annotated[AwareDatetime, AfterValidator(_near)]


class ReservationWanted(_Data):
    """A bench wanted for oneself."""

    begins: _Near = Field(description="with its zone; at most a day ago and a year ahead")
    ends: _Near = Field(description="with its zone, at most 31 days later")
    reason: str = Field(min_length=1, max_length=200, pattern=_LINE)

    @model_validator(mode="after")
    def _possible(self) -> ReservationWanted:
        if not datetime.timedelta(0) < self.ends - self.begins <= LONGEST:
            raise ValueError("ends must be later than begins, by 31 days at most")
        return self


class HandoverWanted(_Data):
    """A note for whoever has the bench next."""

    day: Annotated[datetime.date, AfterValidator(_near_day)] = Field(
        description="yesterday at the earliest, at most a year ahead"
    )
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
