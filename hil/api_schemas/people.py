"""People who sign in by OpenID Connect."""

from __future__ import annotations

import datetime

from pydantic import BaseModel, ConfigDict, Field

from hil.api_schemas.api import Role, RunId


class PersonData(BaseModel):
    """A person who has signed in; the name is theirs alone, whatever the provider calls others."""

    model_config = ConfigDict(extra="forbid")

    id: RunId
    issuer: str = Field(description="the provider's URL")
    subject: str = Field(description="the person at the provider, whatever their name is")
    name: str
    role: Role = Field(description="as their groups had it at the last sign-in")
    signed_in_at: datetime.datetime
