"""Who asks; tokens; what was done by whom."""

from __future__ import annotations

import datetime
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from hil.api_schemas.api import AuditEntry, Login, Me, RunId, TokenData, TokenMade, TokenWanted
from hil.service.api._access import Admin, TheService, Viewer
from hil.service.api._problems import RefusedError, missing
from hil.service.stop_post import COOKIE
from hil.service.store import SESSION_S

router = APIRouter(tags=["people"])
_LAST = 2**31 - 1


@router.get("/me", name="me")
async def get_me(me: Viewer) -> Me:
    """The present user and role."""
    return me


@router.post("/session", name="log_in", status_code=204)
async def log_in(login: Login, service: TheService, request: Request, response: Response) -> None:
    """Open a session of the page with a token; its cookie is not a token, and scripts cannot read it."""
    owner = service.tokens.owner_of(login.secret)
    if owner is None:
        raise RefusedError(
            401,
            "this token is not known, has expired or was revoked",
            fix="enter it as it was made, without anything around it, or ask an administrator for a new one",
        )
    session, by_tls = service.tokens.open_session(owner), request.url.scheme == "https"
    response.set_cookie(
        COOKIE, session, httponly=True, samesite="strict", secure=by_tls, max_age=int(SESSION_S)
    )
    service.owners.changed()
    service.log.add(owner.name, owner.role, "log in", "page")


@router.delete("/session", name="log_out", status_code=204)
async def log_out(service: TheService, request: Request, response: Response) -> None:
    """Close the session; its cookie is no longer valid."""
    session = request.cookies.get(COOKIE)
    if session:
        service.tokens.close_session(session)
        service.people.close_session(session)
        service.owners.changed()
    response.delete_cookie(COOKIE, httponly=True, samesite="strict")


@router.get("/tokens", name="list_tokens")
async def list_tokens(service: TheService, me: Admin) -> list[TokenData]:
    """All tokens, without their secrets."""
    del me
    return service.tokens.all()


@router.post("/tokens", name="make_token", status_code=201)
async def make_token(wanted: TokenWanted, service: TheService, me: Admin) -> TokenMade:
    """Make a token. Make the first one on the service's machine: `hil serve --add-token`."""
    if not me.tokens:
        raise RefusedError(
            403, "make the first token on the service's machine", fix="hil serve --add-token NAME=admin"
        )
    made = service.tokens.make(wanted.name, wanted.role, wanted.for_days)
    service.owners.changed()
    service.log.add(me.name, me.role, "token made", wanted.name, f"{wanted.role}, {wanted.for_days:g} days")
    return made


@router.delete("/tokens/{token}", name="revoke_token", status_code=204)
async def revoke_token(token: RunId, service: TheService, me: Admin) -> None:
    """Revoke a token; the last administrator's cannot be revoked."""
    moment = datetime.datetime.now(datetime.UTC)
    valid = [
        one
        for one in service.tokens.all()
        if one.revoked_at is None and (one.expires_at is None or one.expires_at > moment)
    ]
    if [one.id for one in valid if one.role == "admin"] == [token]:
        raise RefusedError(409, "is the last administrator's", fix="make another administrator's token first")
    if not service.tokens.revoke(token):
        raise missing("valid token", token)
    service.owners.changed()
    service.log.add(me.name, me.role, "token revoked", str(token))


@router.get("/audit", name="audit")
async def audit(
    service: TheService,
    me: Admin,
    before: Annotated[int, Query(ge=1, le=_LAST)] = _LAST,
    most: Annotated[int, Query(ge=1, le=1000)] = 100,
) -> list[AuditEntry]:
    """Audit log: actions and users, newest first."""
    del me
    return service.log.newest(before, most)
