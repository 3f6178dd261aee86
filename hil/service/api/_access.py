"""Who asks, and whether they may."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import APIKeyCookie, HTTPAuthorizationCredentials, HTTPBearer

from hil.service.api._problems import RefusedError
from hil.service.data import ROLES, Me, Role
from hil.service.service import Service

COOKIE = "hil_token"
_bearer = HTTPBearer(auto_error=False, description="a token of the service")
_cookie = APIKeyCookie(name=COOKIE, auto_error=False, description="the same, as the page has it")


def service_of(request: Request) -> Service:
    """The service that answers."""
    found = request.app.state.service
    assert isinstance(found, Service)
    return found


TheService = Annotated[Service, Depends(service_of)]


def who(
    service: TheService,
    header: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
    cookie: Annotated[str | None, Depends(_cookie)],
) -> Me:
    """Who asks. A service without tokens is reached from its own machine only, and asks nobody.

    Raises:
        RefusedError: no token, or none that is valid.
    """
    if not service.tokens.any():
        return Me(name="local", role="admin", tokens=False)
    secret = header.credentials if header is not None else cookie
    owner = service.tokens.owner_of(secret) if secret else None
    if owner is None:
        raise RefusedError(401, "a valid token is needed", fix="send it as 'Authorization: Bearer TOKEN'")
    return Me(name=owner.name, role=owner.role, tokens=True)


def _needs(role: Role) -> Callable[[Me], Me]:
    def check(me: Annotated[Me, Depends(who)]) -> Me:
        if ROLES.index(me.role) < ROLES.index(role):
            raise RefusedError(403, f"{me.name} is {me.role}; {role} is needed", fix="ask who may")
        return me

    return check


Viewer = Annotated[Me, Depends(_needs("viewer"))]
Operator = Annotated[Me, Depends(_needs("operator"))]
Engineer = Annotated[Me, Depends(_needs("engineer"))]
Admin = Annotated[Me, Depends(_needs("admin"))]
