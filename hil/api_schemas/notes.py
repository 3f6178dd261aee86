"""Notes and tags that people add to runs, as they pass over the API."""

from __future__ import annotations

import datetime
from typing import Annotated

from pydantic import Field

from hil.api_schemas.api import RunId, _Data

#: A word by which runs are found again.
Tag = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.:-]{0,39}$")]
MOST_TAGS, MOST_NOTES = 30, 200
#: Lines and tabs are text; other control characters are none, and not every database keeps them.
_PLAIN = r"[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f]"


class NoteWanted(_Data):
    """A note to add to a run."""

    text: str = Field(max_length=4000, pattern=rf"^{_PLAIN}*[^\s\x00-\x1f\x7f]{_PLAIN}*$")


class NoteData(_Data):
    """A note of a run."""

    id: RunId
    at: datetime.datetime
    who: str
    text: str


class RunNotes(_Data):
    """What people have added to a run; notes oldest first."""

    tags: list[str]
    notes: list[NoteData]
