"""People who sign in by OpenID Connect."""

from __future__ import annotations

import datetime

from pydantic import Field

from hil.api_schemas.api import Role, RunId, _Data


class PersonData(_Data):
    """A person who has signed in; the name is theirs alone, whatever the provider calls others."""

    id: RunId
    issuer: str = Field(description="the provider's URL")
    subject: str = Field(description="the person at the provider, whatever their name is")
    name: str
    role: Role = Field(description="as their groups had it at the last sign-in")
    signed_in_at: datetime.datetime
