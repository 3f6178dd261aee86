"""Parameters of a query that an address does not have: refused, for an answer that ignores one misleads."""

from __future__ import annotations

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute
from pydantic import BaseModel

from hil.core.errors.wording import did_you_mean, printable
from hil.service.api._problems import RefusedError


def refuse_unknown_query(request: Request) -> None:
    """Refuse a parameter that the address does not know.

    Raises:
        RefusedError: 422; names the parameter, and those there are.
    """
    if not request.query_params:
        return
    route = request.scope.get("route")
    if not isinstance(route, APIRoute) or route.path.endswith(("/emergency-stop", "/sign-in/return")):
        return  # no one who wants a bench safe is refused for a word too many, and providers add their own
    known = sorted(_names_of(route.dependant))
    for name in request.query_params:
        if name not in known:
            raise RefusedError(
                422,
                f"there is no parameter '{printable(name, 60)}'",
                where=f"query.{printable(name, 60)}",
                fix=did_you_mean(name, known) if known else "leave it out: this address takes none",
            )


def _names_of(dependant: Dependant) -> set[str]:
    """Names of the query's parameters, also those that the address's dependencies take."""
    own: set[str] = set()
    for field in dependant.query_params:
        kind = field.field_info.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            own |= set(kind.model_fields)
        else:
            own.add(field.alias)
    return own.union(*(_names_of(one) for one in dependant.dependencies))
