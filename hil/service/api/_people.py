"""Who asks; tokens; what was done by whom."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from hil.service.api._access import COOKIE, Admin, TheService, Viewer
from hil.service.api._problems import RefusedError, missing
from hil.service.data import AuditEntry, Login, Me, RunId, TokenData, TokenMade, TokenWanted

router = APIRouter(tags=["people"])
_LAST = 2**31 - 1


@router.get("/me", name="me")
async def get_me(me: Viewer) -> Me:
    """Who asks, and what they may do."""
    return me


@router.post("/session", name="log_in", status_code=204)
async def log_in(login: Login, service: TheService, response: Response) -> None:
    """Keep a token in a cookie, for the page: no script can read it, no other site can use it."""
    owner = service.tokens.owner_of(login.secret)
    if owner is None:
        raise RefusedError(401, "is no valid token")
    response.set_cookie(COOKIE, login.secret, httponly=True, samesite="strict", max_age=12 * 3600)
    service.log.add(owner.name, owner.role, "log in", "page")


@router.delete("/session", name="log_out", status_code=204)
async def log_out(response: Response) -> None:
    """Forget the cookie."""
    response.delete_cookie(COOKIE, httponly=True, samesite="strict")


@router.get("/tokens", name="list_tokens")
async def list_tokens(service: TheService, me: Admin) -> list[TokenData]:
    """All tokens, without their secrets."""
    del me
    return service.tokens.all()


@router.post("/tokens", name="make_token", status_code=201)
async def make_token(wanted: TokenWanted, service: TheService, me: Admin) -> TokenMade:
    """Make a token. The first is made where the service runs: `hil serve --add-token`."""
    if not me.tokens:
        raise RefusedError(
            403, "the first token is made on the service's machine", fix="hil serve --add-token NAME=admin"
        )
    made = service.tokens.make(wanted.name, wanted.role)
    service.log.add(me.name, me.role, "token made", wanted.name, wanted.role)
    return made


@router.delete("/tokens/{token}", name="revoke_token", status_code=204)
async def revoke_token(token: RunId, service: TheService, me: Admin) -> None:
    """Make a token worthless; the last administrator's stays."""
    valid = [one for one in service.tokens.all() if one.revoked_at is None]
    if [one.id for one in valid if one.role == "admin"] == [token]:
        raise RefusedError(409, "is the last administrator's", fix="make another administrator's token first")
    if not service.tokens.revoke(token):
        raise missing("valid token", token)
    service.log.add(me.name, me.role, "token revoked", str(token))


@router.get("/audit", name="audit")
async def audit(
    service: TheService,
    me: Admin,
    before: Annotated[int, Query(ge=1, le=_LAST)] = _LAST,
    most: Annotated[int, Query(ge=1, le=1000)] = 100,
) -> list[AuditEntry]:
    """What was done by whom, newest first."""
    del me
    return service.log.newest(before, most)
