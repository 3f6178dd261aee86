"""Signing in by OpenID Connect, there and back, and who has signed in (docs/how-to/sign-in.md).

The way back carries a code that is worth nothing without this service's verifier and its secret; the cookie
that is set then is like that of a token's session. The page has a sentence for each reason of a refusal.
"""

from __future__ import annotations

import logging
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import RedirectResponse

from hil.api_schemas.api import RunId
from hil.api_schemas.people import PersonData
from hil.core.errors.wording import shortened
from hil.service.api._access import Admin, TheService
from hil.service.api._problems import RefusedError, missing
from hil.service.service import Service
from hil.service.sign_in import SignedIn, SignIn, SignInError, local_place
from hil.service.stop_post import COOKIE

router = APIRouter(tags=["people"])
#: Of the browser that is signing in: it comes along when the provider sends that back, so it is `Lax`.
_UNDER_WAY = "hil_sign_in"
_UNDER_WAY_S = 600
_PATH = "/api/v1/sign-in"
_ANSWERS: dict[int | str, dict[str, Any]] = {303: {"description": "to the provider, or back to the page"}}
_Text = Annotated[str, Query(max_length=4000)]

logger = logging.getLogger(__name__)


@router.get("/sign-in", name="sign_in", status_code=303, response_class=RedirectResponse, responses=_ANSWERS)
async def sign_in(
    service: TheService, place: Annotated[str, Query(max_length=2000)] = "/"
) -> RedirectResponse:
    """Go to the provider to sign in; afterwards the page goes on at `place`."""
    found = _sign_in_of(service)
    try:
        request = await found.begin(local_place(place))
    except SignInError as error:
        return _refused(error)
    answer = RedirectResponse(request.url, 303)
    answer.set_cookie(
        _UNDER_WAY,
        request.browser,
        httponly=True,
        samesite="lax",
        secure=_by_tls(found),
        max_age=_UNDER_WAY_S,
        path=_PATH,
    )
    return answer


@router.get(
    "/sign-in/return",
    name="return_from_sign_in",
    status_code=303,
    response_class=RedirectResponse,
    responses=_ANSWERS,
)
async def return_from_sign_in(
    service: TheService,
    request: Request,
    state: _Text = "",
    code: _Text = "",
    error: _Text = "",
) -> RedirectResponse:
    """Where the provider sends people back to; opens a session of the page."""
    found = _sign_in_of(service)
    try:
        person = await found.finish(state, request.cookies.get(_UNDER_WAY, ""), code, error)
        answer = _opened(service, found, person)
    except SignInError as refused:
        answer = _refused(refused)
    answer.delete_cookie(_UNDER_WAY, path=_PATH, httponly=True, samesite="lax")
    return answer


def _opened(service: Service, found: SignIn, signed_in: SignedIn) -> RedirectResponse:
    """Open a session of somebody with a role; of others all are closed.

    Raises:
        SignInError: no group of theirs has a role.
    """
    subject = f"subject {signed_in.subject} of {signed_in.issuer}"
    if signed_in.role is None:
        service.people.refuse(signed_in.issuer, signed_in.subject)
        service.owners.changed()
        # The name may be that of somebody else here.
        who = shortened(f"{shortened(signed_in.name, 40)} ({signed_in.subject})", 100)
        service.log.add(who, "", "sign in refused", "page", f"{subject}: no group has a role")
        raise SignInError("no_role", f"{subject} has no group with a role")
    hours = found.settings.session_hours
    person, secret = service.people.sign_in(
        signed_in.issuer,
        signed_in.subject,
        signed_in.name,
        signed_in.role,
        hours,
    )
    service.owners.changed()
    service.log.add(person.name, person.role, "sign in", "page", f"{subject}, by group {signed_in.group}")
    answer = RedirectResponse(signed_in.place, 303)
    answer.set_cookie(
        COOKIE, secret, httponly=True, samesite="strict", secure=_by_tls(found), max_age=int(3600 * hours)
    )
    return answer


@router.get("/people", name="list_people")
async def list_people(service: TheService, me: Admin) -> list[PersonData]:
    """People who have signed in by OpenID Connect."""
    del me
    return service.people.all()


@router.delete("/people/{person}/sessions", name="close_sessions", status_code=204)
async def close_sessions(person: RunId, service: TheService, me: Admin) -> None:
    """Sign somebody out everywhere; only the provider keeps them from signing in again."""
    found = service.people.close_all(person)
    if found is None:
        raise missing("person", person)
    service.owners.changed()
    service.log.add(me.name, me.role, "signed out", found.name, f"subject {found.subject} of {found.issuer}")


def _sign_in_of(service: Service) -> SignIn:
    if service.sign_in is None:
        raise RefusedError(
            404, "this service has no sign-in", fix="send a token, or start it with --sign-in FILE"
        )
    return service.sign_in


def _refused(error: SignInError) -> RedirectResponse:
    logger.warning("a sign-in is refused: %s", error)
    return RedirectResponse(f"/?sign_in={error.reason}", 303)


def _by_tls(found: SignIn) -> bool:
    return found.settings.address.startswith("https://")
