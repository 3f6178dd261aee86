"""A sign-in from its beginning to a person with a role."""

from __future__ import annotations

import asyncio
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hil.api_schemas.api import Role
from hil.core.errors.wording import shortened
from hil.execution.background import apart
from hil.service.sign_in._settings import SignInSettings
from hil.service.sign_in._tried import SignInError, TriedOnes

#: Each has a thread that waits for the provider.
_AT_ONCE = 8
_LONGEST_NAME = 100


@dataclass(frozen=True)
class SignInRequest:
    """Where the browser is sent, and the secret of its cookie."""

    url: str
    browser: str


@dataclass(frozen=True)
class SignedIn:
    """Who the provider vouches for; `role` and the `group` that gives it, None and '' if no group does."""

    issuer: str
    subject: str
    name: str
    role: Role | None
    group: str
    place: str


class SignIn:
    """Signs people in by the provider of the settings."""

    def __init__(self, settings: SignInSettings) -> None:
        from hil.service.sign_in._provider import Provider  # the extra 'sign-in' brings what it needs

        self.settings = settings
        self._provider = Provider(settings)
        self._tried = TriedOnes()
        self._turns = asyncio.Semaphore(_AT_ONCE)

    async def begin(self, place: str) -> SignInRequest:
        """Begin one, which goes on at a place of the page.

        Raises:
            SignInError: the provider does not answer as one.
        """
        tried = self._tried.begin(place)
        async with self._turns:
            return SignInRequest(await apart(lambda: self._provider.authorization_url(tried)), tried.browser)

    async def finish(self, state: str, browser: str, code: str, refusal: str) -> SignedIn:
        """Who comes back from the provider with a code, or with why there is none.

        Raises:
            SignInError: the provider vouches for no one.
        """
        tried = self._tried.take(state, browser)
        if refusal or not code:
            raise SignInError("declined", "the provider signs no one in")
        async with self._turns:
            claims = await apart(lambda: self._provider.claims(code, tried))
        role, group = self.settings.role_of(_groups(claims, self.settings.groups_claim)) or (None, "")
        name = _name(claims, self.settings.name_claim)
        return SignedIn(self.settings.issuer, claims["sub"], name, role, group, tried.place)


def local_place(place: str) -> str:
    """A place of the page; its first view for what would lead elsewhere."""
    inside = place.startswith("/") and not place.startswith(("//", "/\\", "/api/"))
    return place if inside and place.isprintable() and "\\" not in place else "/"


def _groups(claims: Mapping[str, Any], claim: str) -> list[str]:
    """A claim of several texts, or of one; a dot leads into an object where no claim has the whole name."""
    found: Any = claims.get(claim)
    if found is None:
        found = claims
        for part in claim.split("."):
            found = found.get(part) if isinstance(found, Mapping) else None
    values = [found] if isinstance(found, str) else found
    return [one for one in values if isinstance(one, str)] if isinstance(values, list) else []


def _name(claims: Mapping[str, Any], claim: str) -> str:
    """As it stands in reports: printable, on one line."""
    for found in (claims.get(claim), claims.get("preferred_username"), claims["sub"]):
        if isinstance(found, str):
            words = "".join(one if one.isprintable() else " " for one in unicodedata.normalize("NFKC", found))
            name = shortened(" ".join(words.split()), _LONGEST_NAME)
            if name:
                return name
    return "unnamed"
