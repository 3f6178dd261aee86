"""Models, controllers and bench files as somebody writes them, checked before they are given; versions."""

from __future__ import annotations

import datetime
from typing import Literal

from pydantic import Field

from hil.api_schemas.api import _Data
from hil.api_schemas.design import FileName
from hil.api_schemas.plan_check import MOST_CHARACTERS, PlanMistake

WrittenKind = Literal["model", "controller", "bench"]


class FileCheckWanted(_Data):
    """The text of a file (TOML), and the name that it is to be given."""

    kind: WrittenKind
    name: FileName
    text: str = Field(max_length=MOST_CHARACTERS)
    model: FileName | None = Field(None, description="for the margins of a controller")


class CheckedFigure(_Data):
    """A quantity that follows from a file; `value` is null where `text` says it."""

    name: str
    value: float | None
    unit: str = ""
    text: str = ""


class FileCheck(_Data):
    """All mistakes of a file; without one, what follows from it."""

    mistakes: list[PlanMistake]
    figures: list[CheckedFigure] = Field([])
    notes: list[str] = Field([], description="what cannot be computed, or was assumed")


class BenchFileData(_Data):
    """A bench file."""

    name: str
    title: str
    simulated: bool
    built_in: bool
    served: bool = Field(False, description="whether it is a bench of this service by now")


class VersionData(_Data):
    """A version of a file that was given, replaced or removed since or not."""

    number: int
    name: str = Field(description="under which it was given")
    sha256: str
    given_by: str
    given_at: datetime.datetime
