"""The list of all runs: what is chosen of it, and a page of what was found (docs/reference/api.md)."""

from __future__ import annotations

import datetime
from typing import Annotated, Literal

from pydantic import Field

from hil.api_schemas.api import BenchName, Number, PlanName, RunData, RunState, RunVerdict, _Data
from hil.api_schemas.notes import Tag

#: What runs are sorted by; `value` is that of the criterion that is asked for.
RunOrder = Literal["run", "plan", "bench", "dut", "verdict", "ended", "duration", "value"]
_Words = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")]
LONGEST_PAGE = 200
#: Beyond it no one pages: a filter finds what lies there.
FARTHEST = 1_000_000


class RunsWanted(_Data):
    """Which runs of all, in which order, from which place on; an empty filter lets all pass."""

    bench: list[BenchName] = Field([], max_length=50)
    plan: list[PlanName] = Field([], max_length=50)
    dut: list[_Words] = Field([], max_length=50, description="serial number or name of the tested device")
    state: list[RunState] = Field([], max_length=6)
    verdict: list[RunVerdict] = Field([], max_length=4)
    requested_by: list[_Words] = Field([], max_length=50)
    tag: list[Tag] = Field([], max_length=20, description="one of these tags, that people have added")
    since: datetime.datetime | None = Field(
        None, description="ended, or queued if it has not ended, at or after"
    )
    until: datetime.datetime | None = Field(None, description="ended, or queued if it has not ended, before")
    text: _Words = Field(
        "", description="part of plan, title, device, person, reason of the end or a note, whatever the case"
    )
    criterion: _Words = Field("", description="only runs that have it; its values are given, too")
    above: Number | None = Field(None, description="value of the criterion at least, in its unit")
    below: Number | None = Field(None, description="value of the criterion at most, in its unit")
    sort: RunOrder = "run"
    rising: bool = Field(False, description="true: smallest, first or oldest at the top")
    first: int = Field(0, ge=0, le=FARTHEST, description="how many are left out before the page")
    most: int = Field(50, ge=1, le=LONGEST_PAGE)


class FoundRun(_Data):
    """A run of the list, with the criterion that was asked for."""

    run: RunData
    value: float | None = None
    unit: str = ""
    upper: float | None = None
    lower: float | None = None
    criterion_verdict: str = ""
    tags: list[str] = Field([])


class FoundRuns(_Data):
    """A page of the runs found, and how many there are of them in all."""

    runs: list[FoundRun]
    total: int


class RunChoices(_Data):
    """What runs can be filtered by: every value that there is, in order."""

    benches: list[str]
    plans: list[str]
    duts: list[str]
    people: list[str]
    tags: list[str]
    criteria: list[str] = Field(description="of the newest runs of the plans given, or of all")
