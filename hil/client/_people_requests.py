"""Who asks, tokens, and what was done by whom."""

from __future__ import annotations

from hil.api_schemas.api import AuditEntry, Me, Role, TokenData, TokenMade, TokenWanted
from hil.api_schemas.people import PersonData
from hil.client._requests import Requests


class PeopleRequests(Requests):
    """Who asks, tokens, and what was done by whom."""

    def me(self) -> Me:
        """Who asks, and what they may do."""
        return self._one(Me, "GET", "/me")

    def tokens(self) -> list[TokenData]:
        """All tokens, without their secrets."""
        return self._several(TokenData, "/tokens")

    def make_token(self, name: str, role: Role, for_days: float = 365.0) -> TokenMade:
        """Make a token that is valid for so many days; its secret is reported this once."""
        return self._one(TokenMade, "POST", "/tokens", TokenWanted(name=name, role=role, for_days=for_days))

    def people(self) -> list[PersonData]:
        """People who have signed in by OpenID Connect."""
        return self._several(PersonData, "/people")

    def close_sessions(self, person: int) -> None:
        """Sign somebody out everywhere."""
        self._done("DELETE", f"/people/{person}/sessions")

    def audit(self, most: int = 100) -> list[AuditEntry]:
        """What was done by whom, newest first."""
        return self._several(AuditEntry, f"/audit?most={most}")
