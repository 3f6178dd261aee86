"""Plans, controllers and models that people give, as services of one database share them."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

#: Of which every text that was given is kept.
VersionedKind = Literal["model", "controller", "plan", "bench"]
GivenKind = Literal[VersionedKind, "picture"]


class KeptApart(BaseModel):
    """A file of an earlier version's folder that is not shared between services."""

    model_config = ConfigDict(extra="forbid")

    kind: GivenKind
    name: str
    file: str = Field(description="where it lies, below the service's --data")
    why: str
    fix: str
