"""The page and its parts, all of them from this package: no other network is asked for anything."""

from __future__ import annotations

from importlib import resources

from fastapi import FastAPI
from fastapi.responses import Response

from reports.style import css_variables

_KINDS = {"html": "text/html", "css": "text/css", "js": "text/javascript", "svg": "image/svg+xml"}


def add_to(app: FastAPI) -> None:
    """Answer for the page."""
    for place in resources.files("hil.service").joinpath("page").iterdir():
        kind = _KINDS.get(place.name.rpartition(".")[2])
        if kind is not None:
            _add(app, "/" if place.name == "index.html" else f"/{place.name}", place.read_bytes(), kind)
    colours = (
        f":root {{ color-scheme: light dark; {css_variables('light')} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root {{ {css_variables('dark')} }} }}\n"
    )
    _add(app, "/colours.css", colours.encode(), "text/css")


def _add(app: FastAPI, path: str, content: bytes, kind: str) -> None:
    async def answer() -> Response:
        return Response(content, media_type=kind)

    app.add_api_route(path, answer, include_in_schema=False)
