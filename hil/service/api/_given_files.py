"""Files that are given, as every kind of them is listed, described and sent."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

from fastapi import Request, Response

from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.service.api._problems import RefusedError, missing
from hil.service.files.catalogues import Catalogue

T = TypeVar("T")
_TOML = "application/toml"
#: Of a request that carries such a file.
GIVEN: dict[str, Any] = {
    "requestBody": {"required": True, "content": {_TOML: {"schema": {"type": "string"}}}}
}
#: Of one that carries a piece of a file.
PIECE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}


def readable(catalogue: Catalogue[Any], describe: Callable[[Catalogue[Any], str, Path], T]) -> Iterator[T]:
    """The description of all that can still be read."""
    for name, path in catalogue.paths().items():
        with contextlib.suppress(BadInputError):
            yield describe(catalogue, name, path)


def described(
    catalogue: Catalogue[Any], describe: Callable[[Catalogue[Any], str, Path], T], kind: str, name: str
) -> T:
    """The description of one.

    Raises:
        RefusedError: there is none of the name.
    """
    path = catalogue.path(name)
    if path is None:
        raise missing(kind, name)
    return describe(catalogue, name, path)


def file_text(catalogue: Catalogue[Any], kind: str, name: str) -> Response:
    """The file of one.

    Raises:
        RefusedError: there is none of the name.
    """
    path = catalogue.path(name)
    if path is None:
        raise missing(kind, name)
    headers = {"content-disposition": f'attachment; filename="{name}.toml"'}
    return Response(read_text(path), media_type=_TOML, headers=headers)


async def body_of(request: Request, where: str) -> str:
    """The text that a request carries.

    Raises:
        RefusedError: it is not UTF-8.
    """
    try:
        return (await request.body()).decode("utf-8")
    except UnicodeDecodeError as error:
        raise RefusedError(422, "is not UTF-8", where=where) from error
