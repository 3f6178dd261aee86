"""The page that Vite builds (hil/service/frontend): all addresses below /app give one document.

What an address shows is the page's own matter, so that each can be sent, kept and loaded again. The document
is never kept by a browser, its parts always: their names change with their content.
"""

from __future__ import annotations

from importlib import resources
from importlib.resources.abc import Traversable

from fastapi import FastAPI
from fastapi.responses import Response

from hil.service.api._problems import RefusedError

#: Where the addresses of the page begin.
APP = "/app"
_KINDS = {"html": "text/html", "css": "text/css", "js": "text/javascript", "md": "text/markdown"}
_FOR_GOOD = {"cache-control": "public, max-age=31536000, immutable"}


def add_to(app: FastAPI, built: Traversable | None = None) -> None:
    """Answer for every address of the page.

    Args:
        built: the folder that the build left; None for that of the package.
    """
    folder = built or resources.files("hil.service").joinpath("frontend/built")
    document, parts = _document(folder), _parts(folder)

    async def page(place: str = "") -> Response:
        del place
        if document is None:
            raise RefusedError(503, "the page is not built", fix="make page")
        return Response(document, media_type="text/html")

    async def part(name: str) -> Response:
        if name not in parts:
            raise RefusedError(404, f"there is no part '{name[:100]}' of the page", fix="load the page again")
        return Response(parts[name], media_type=_kind(name), headers=_FOR_GOOD)

    app.add_api_route(f"{APP}/assets/{{name}}", part, include_in_schema=False)
    app.add_api_route(APP, page, include_in_schema=False)
    app.add_api_route(f"{APP}/{{place:path}}", page, include_in_schema=False)


def _document(folder: Traversable) -> bytes | None:
    file = folder.joinpath("index.html")
    return file.read_bytes() if file.is_file() else None


def _parts(folder: Traversable) -> dict[str, bytes]:
    assets = folder.joinpath("assets")
    return {one.name: one.read_bytes() for one in assets.iterdir()} if assets.is_dir() else {}


def _kind(name: str) -> str:
    return _KINDS.get(name.rpartition(".")[2], "application/octet-stream")
