"""Who asks, and whether they may."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import APIKeyCookie, HTTPAuthorizationCredentials, HTTPBearer

from hil.api_schemas.api import LADDER, Me, Role, TokenData
from hil.api_schemas.people import PersonData
from hil.service.api._problems import RefusedError
from hil.service.service import Service
from hil.service.stop_post import COOKIE
from hil.service.store import DatabaseAwayError

_MOST = 1000
_bearer = HTTPBearer(auto_error=False, description="a token of the service")
_cookie = APIKeyCookie(name=COOKIE, auto_error=False, description="a session of the page")


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
    """Who asks. A service without tokens is reached from its own machine only, and asks no one.

    Raises:
        RefusedError: no token, or none that is valid.
    """
    if service.sign_in is None and not service.tokens.any():
        return Me(name="local", role="admin", tokens=False)
    owner: TokenData | PersonData | None = None
    if header is not None:
        owner = service.tokens.owner_of(header.credentials)
    elif cookie:
        owner = service.tokens.owner_of_session(cookie)
        if owner is None and service.sign_in is not None:
            owner = service.people.of_session(cookie)
    if owner is None:
        raise RefusedError(401, "a valid token is needed", fix="send it as 'Authorization: Bearer TOKEN'")
    return Me(name=owner.name, role=owner.role, tokens=True)


def _still(
    service: TheService,
    header: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
    cookie: Annotated[str | None, Depends(_cookie)],
    me: Annotated[Me, Depends(who)],
) -> Callable[[], bool]:
    """Whether who asked may still look: what is sent for long must end with the token or session.

    Mostly from memory, for it is asked many times a second. One that is not known there may be newer than
    what is: then the database decides, and one that is away ends nothing.
    """
    secret = header.credentials if header is not None else cookie or ""

    def check() -> bool:
        if service.owners.of(secret) is not None or (not me.tokens and not service.owners.any()):
            return True
        try:
            who(service, header, cookie)
        except RefusedError:
            return False
        except DatabaseAwayError:
            return True
        return True

    return check


def _needs(role: Role) -> Callable[[Me], Me]:
    def check(me: Annotated[Me, Depends(who)]) -> Me:
        if me.role not in LADDER or LADDER.index(me.role) < LADDER.index(role):
            raise RefusedError(
                403, f"{me.name} is {me.role}; {role} is needed", fix="ask an administrator for the role"
            )
        return me

    return check


def _agent(
    service: TheService,
    header: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
    cookie: Annotated[str | None, Depends(_cookie)],
) -> Me:
    """An agent, or who may do everything; one that was known stays so while the database is away.

    Otherwise no emergency stop would reach it then.

    Raises:
        RefusedError: another role.
    """
    secret = header.credentials if header is not None else cookie or ""
    try:
        me = who(service, header, cookie)
    except DatabaseAwayError:
        known = service.known_agents.get(secret)
        if known is None:
            raise
        return known
    if me.role not in ("agent", "admin"):
        raise RefusedError(
            403, f"{me.name} is {me.role}; agent is needed", fix="ask an administrator for the role"
        )
    service.known_agents = {**service.known_agents, secret: me} if len(service.known_agents) < _MOST else {}
    return me


Still = Annotated[Callable[[], bool], Depends(_still)]
AgentItself = Annotated[Me, Depends(_agent)]
Viewer = Annotated[Me, Depends(_needs("viewer"))]
Operator = Annotated[Me, Depends(_needs("operator"))]
Engineer = Annotated[Me, Depends(_needs("engineer"))]
Admin = Annotated[Me, Depends(_needs("admin"))]
