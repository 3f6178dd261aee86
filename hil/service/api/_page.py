"""The page that Vite builds (hil/service/frontend): every address that is not the API's gives one document.

What an address shows is the page's own matter, so that each can be sent, kept and loaded again. The document
is never kept by a browser, its parts always: their names change with their content. Nothing comes from
another network.
"""

from __future__ import annotations

from importlib import resources
from importlib.resources.abc import Traversable

from fastapi import FastAPI
from fastapi.responses import RedirectResponse, Response
from starlette.requests import Request
from starlette.routing import Match, Route
from starlette.types import Scope

from hil.core.errors.wording import shortened
from hil.service.api._problems import RefusedError
from reports.style import css_variables

#: Where the page's addresses began while there were two pages.
_FORMER = "/app"
_KINDS = {
    "css": "text/css",
    "html": "text/html",
    "js": "text/javascript",
    "md": "text/markdown",
    "svg": "image/svg+xml",
}
_FOR_GOOD = {"cache-control": "public, max-age=31536000, immutable"}


def add_to(app: FastAPI, built: Traversable | None = None) -> None:
    """Answer for every address of the page; after all routes of the API.

    Args:
        built: the folder that the build left; None for that of the package.
    """
    folder = built or resources.files("hil.service").joinpath("frontend/built")
    document, icon, parts = _content(folder, "index.html"), _content(folder, "icon.svg"), _parts(folder)
    colours = _colours().encode()

    async def page(request: Request) -> Response:
        del request
        if document is None:
            raise RefusedError(503, "the page is not built", fix="make page")
        return Response(document, media_type="text/html")

    async def part(request: Request) -> Response:
        name = request.path_params["name"]
        if name not in parts:
            raise RefusedError(
                404, f"there is no part '{shortened(name, 100)}' of the page", fix="load the page again"
            )
        return Response(parts[name], media_type=_kind(name), headers=_FOR_GOOD)

    async def picture(request: Request) -> Response:
        del request
        return Response(icon or b"", media_type=_KINDS["svg"], status_code=200 if icon else 404)

    async def palette(request: Request) -> Response:
        del request
        return Response(colours, media_type=_KINDS["css"])

    app.router.routes += [
        Route("/assets/{name}", part),
        Route("/icon.svg", picture),
        Route("/colours.css", palette),
        Route(_FORMER, _moved),
        Route(f"{_FORMER}/{{place:path}}", _moved),
        _PageRoute("/{place:path}", page),
    ]


class _PageRoute(Route):
    """All but the API's: what that does not know is a mistake of a program, and no view."""

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        if f"{scope['path']}/".startswith("/api/"):
            return Match.NONE, {}
        return super().matches(scope)


async def _moved(request: Request) -> Response:
    place = "/" + request.url.path.removeprefix(_FORMER).lstrip("/\\")  # never to another host
    return RedirectResponse(place + (f"?{request.url.query}" if request.url.query else ""), 308)


def _content(folder: Traversable, name: str) -> bytes | None:
    file = folder.joinpath(name)
    return file.read_bytes() if file.is_file() else None


def _parts(folder: Traversable) -> dict[str, bytes]:
    assets = folder.joinpath("assets")
    return {one.name: one.read_bytes() for one in assets.iterdir()} if assets.is_dir() else {}


def _kind(name: str) -> str:
    return _KINDS.get(name.rpartition(".")[2], "application/octet-stream")


def _colours() -> str:
    """The house's colours as the system has them, or as `data-theme` of the document says."""
    light, dark = css_variables("light"), css_variables("dark")
    return (
        f":root {{ color-scheme: light dark; {light} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"
        f':root[data-theme="light"] {{ color-scheme: light; {light} }}\n'
        f':root[data-theme="dark"] {{ color-scheme: dark; {dark} }}\n'
    )
