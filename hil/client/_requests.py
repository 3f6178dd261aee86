"""A request to a bench service, and what is made of its answer."""

from __future__ import annotations

import json
import queue
import shutil
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Callable, Sequence
from http.client import HTTPException, HTTPResponse
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, TypeAdapter, ValidationError

from hil.api_schemas.api import Problem
from hil.core.errors import BenchError
from hil.core.files import replacing

A = TypeVar("A")
T = TypeVar("T", bound=BaseModel)
WITHIN_S = 30.0
_AGAIN_S = 0.02
#: What a request carries: JSON, a text, or bytes of a file.
_Body = BaseModel | str | bytes | None


_KINDS = {str: "application/yaml", bytes: "application/octet-stream"}


class RefusedError(BenchError):
    """The service has refused a request: `status` is that of HTTP."""

    def __init__(self, status: int, problem: Problem) -> None:
        super().__init__(problem.what, where=problem.where, fix=problem.fix)
        self.status = status


class Requests:
    """Requests to one service, by one who asks.

    Args:
        url: where it is.
        token: who asks; empty if no one is asked.
    """

    def __init__(self, url: str, token: str = "") -> None:
        self._url, self._token = url.rstrip("/"), token

    def _download(self, what: str, path: Path) -> None:
        with (
            self._opened("GET", what, None, WITHIN_S) as answer,
            replacing(path) as temporary,
            temporary.open("wb") as file,
        ):
            shutil.copyfileobj(answer, file)

    def _one(
        self,
        kind: type[T],
        method: str,
        path: str,
        body: _Body = None,
        within_s: float = WITHIN_S,
    ) -> T:
        return _checked(TypeAdapter(kind), self._json(method, path, body, within_s))

    def _several(self, kind: type[T], path: str) -> list[T]:
        return _checked(TypeAdapter(list[kind]), self._json("GET", path, None, WITHIN_S))  # type: ignore[valid-type]

    def _json(self, method: str, path: str, body: _Body, within_s: float) -> Any:
        try:
            with self._opened(method, path, body, within_s) as answer:
                return json.load(answer)
        except (ValueError, HTTPException, OSError) as error:
            raise self._unreachable(error) from error

    def _done(self, method: str, path: str) -> None:
        with self._opened(method, path, None, WITHIN_S):
            pass

    def _opened(self, method: str, path: str, body: _Body, within_s: float) -> HTTPResponse:
        headers = {"Authorization": f"Bearer {self._token}"} if self._token else {}
        if body is not None:
            headers["Content-Type"] = _KINDS.get(type(body), "application/json")
        content = body.model_dump_json() if isinstance(body, BaseModel) else body
        data = content.encode() if isinstance(content, str) else content
        try:
            request = urllib.request.Request(f"{self._url}/api/v1{path}", data, headers, method=method)
            answer: HTTPResponse = _opener.open(request, timeout=within_s)
        except urllib.error.HTTPError as error:
            with error:
                raise RefusedError(error.code, _problem(error)) from None
        except (OSError, ValueError, HTTPException) as error:
            raise self._unreachable(error) from error
        return answer

    def _unreachable(self, error: Exception) -> BenchError:
        reason = getattr(error, "reason", error)
        return BenchError(
            f"the service cannot be reached: {reason}",
            where=self._url,
            fix="check that hil serve is running and that the URL is the one it printed",
        )


def first_of(ways: Sequence[Callable[[], object]], within_s: float) -> None:
    """Go several ways at the same moment; return as soon as one has led there.

    A way on which no one answers is tried again and again: a flooded service closes connections.

    Raises:
        BenchError: none has led there in time, or each was refused; it is what the last one met.
    """
    ended: queue.SimpleQueue[BenchError | None] = queue.SimpleQueue()
    until_s = time.monotonic() + within_s

    def go(way: Callable[[], object]) -> None:
        while True:
            try:
                way()
            except RefusedError as error:
                ended.put(error)
            except BenchError as error:
                if time.monotonic() < until_s:
                    time.sleep(_AGAIN_S)
                    continue
                ended.put(error)
            else:
                ended.put(None)
            return

    for way in ways:
        threading.Thread(target=go, args=(way,), daemon=True).start()
    failure: BenchError | None = None
    for _ in ways:
        failure = ended.get()
        if failure is None:
            return
    if failure is not None:
        raise failure


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """A token is for one service: it follows no one elsewhere."""

    def redirect_request(self, *arguments: Any, **named: Any) -> None:
        """Follow nothing."""
        del arguments, named


_opener = urllib.request.build_opener(_NoRedirect)


def _checked(adapter: TypeAdapter[A], found: Any) -> A:
    try:
        return adapter.validate_python(found)
    except ValidationError as error:
        raise BenchError(
            f"this version cannot read the service's answer: {error.errors()[0]['msg']}",
            where="service",
            fix="install the same version of eaxle-hil on both sides",
        ) from error


def _problem(error: urllib.error.HTTPError) -> Problem:
    try:
        return Problem.model_validate_json(error.read())
    except (ValidationError, OSError, HTTPException):
        return Problem(what=f"status {error.code}", where=str(error.url))


def part(name: str) -> str:
    """A name as a part of a path."""
    return urllib.parse.quote(name, safe="")
