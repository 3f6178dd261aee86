"""Notes and tags that people add to runs, as they pass over the API."""

from __future__ import annotations

import datetime
import unicodedata
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field

from hil.api_schemas.api import RunId, _Data

_LONGEST_TAG = 40
_TAG_WORDS = (
    f"must be 1 to {_LONGEST_TAG} letters and digits of any script, _ . : and -, the first a letter or digit"
)


def _composed(text: object) -> object:
    """In one form (Unicode normalization form C): tags that look the same are the same."""
    return unicodedata.normalize("NFC", text) if isinstance(text, str) else text


def _tag(text: str) -> str:
    kinds = [unicodedata.category(one)[0] for one in text]
    if kinds[0] not in "LN" or not all(
        kind in "LMN" or one in "_.:-" for one, kind in zip(text, kinds, strict=True)
    ):
        raise ValueError(_TAG_WORDS)
    return text


#: A word by which runs are found again.
Tag = Annotated[
    str, BeforeValidator(_composed), Field(min_length=1, max_length=_LONGEST_TAG), AfterValidator(_tag)
]
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
