"""Errors as answers: what, where, and what to do."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from sqlalchemy.exc import SQLAlchemyError
from starlette.exceptions import HTTPException

from hil.api_schemas.api import Problem, Record
from hil.core.errors import BadInputError, HilError
from hil.service.api._wording import problem_of
from hil.service.files.uploads import NameTakenError
from hil.service.plain_words import without_folders
from hil.service.store import DatabaseAwayError

R = TypeVar("R", bound=Record)
#: Where the shipped plans, models and controllers lie: they are called by their names.
_PACKAGES = Path(__file__).parents[3]
_MEANINGS = {
    400: "the body does not match its content type",
    401: "the token is missing or not valid",
    403: "the token's role does not permit this",
    404: "not found",
    405: "method not allowed",
    409: "not possible in the present state, or the name has other content",
    413: "too large",
    416: "the range is outside of the file",
    421: "unknown host name",
    422: "invalid input",
    429: "too many requests; retry after the time in Retry-After",
    503: "the bench, the store or a process of the service failed",
}
RESPONSES: dict[int | str, dict[str, Any]] = {
    code: {"model": Problem, "description": meaning} for code, meaning in _MEANINGS.items()
}


class RefusedError(Exception):
    """An answer with a status of HTTP."""

    def __init__(self, status: int, what: str, *, where: str = "", fix: str = "") -> None:
        super().__init__(what)
        self.status, self.problem = status, Problem(what=what, where=where, fix=fix)


def missing(kind: str, name: object) -> RefusedError:
    """There is no such thing."""
    return RefusedError(404, f"there is no {kind} '{name}'")


def refuse_elsewhere(kind: str, found: R) -> R:
    """What was found, if it is this service's.

    Raises:
        RefusedError: it is another service's.
    """
    if found.place:
        raise RefusedError(409, f"{kind} {found.id} belongs to another service", fix=f"ask {found.place}")
    return found


def answer_problems(app: FastAPI) -> None:
    """Have every error answered as a `Problem`."""
    app.add_exception_handler(RefusedError, _refused)
    app.add_exception_handler(HilError, _of_ours)
    app.add_exception_handler(RequestValidationError, _not_valid)
    app.add_exception_handler(HTTPException, _of_http)
    app.add_exception_handler(SQLAlchemyError, _of_the_store)


def _answer(status: int, problem: Problem, headers: dict[str, str] | None = None) -> JSONResponse:
    return JSONResponse(problem.model_dump(), status, headers)


async def _refused(request: Request, error: Exception) -> JSONResponse:
    del request
    assert isinstance(error, RefusedError)
    headers = {"WWW-Authenticate": "Bearer"} if error.status == 401 else None
    return _answer(error.status, error.problem, headers)


async def _of_ours(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HilError)
    status = 422 if isinstance(error, BadInputError) else 503
    if isinstance(error, NameTakenError):
        status = 409
    headers = {"Retry-After": "5"} if isinstance(error, DatabaseAwayError) else None
    folders = (request.app.state.service.folder, _PACKAGES)
    what, where, fix = (without_folders(text, folders) for text in (error.what, error.where, error.fix))
    return _answer(status, Problem(what=what, where=where, fix=fix), headers)


async def _not_valid(request: Request, error: Exception) -> JSONResponse:
    del request
    assert isinstance(error, RequestValidationError)
    return _answer(422, problem_of(error.errors()))


async def _of_http(request: Request, error: Exception) -> JSONResponse:
    del request
    assert isinstance(error, HTTPException)
    headers = dict(error.headers) if error.headers else None
    return _answer(error.status_code, Problem(what=str(error.detail)), headers)


async def _of_the_store(request: Request, error: Exception) -> JSONResponse:
    del request
    what = f"the store failed: {type(error).__name__}"
    return _answer(503, Problem(what=what, fix="check the service's log and its disk"))
