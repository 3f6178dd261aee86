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
    _add(app, "/colours.css", _colours().encode(), "text/css")


def _colours() -> str:
    """The house's colours as the system has them, or as `data-theme` of the document says."""
    light, dark = css_variables("light"), css_variables("dark")
    return (
        f":root {{ color-scheme: light dark; {light} }}\n"
        f"@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"
        f':root[data-theme="light"] {{ color-scheme: light; {light} }}\n'
        f':root[data-theme="dark"] {{ color-scheme: dark; {dark} }}\n'
    )


def _add(app: FastAPI, path: str, content: bytes, kind: str) -> None:
    async def answer() -> Response:
        return Response(content, media_type=kind)

    app.add_api_route(path, answer, include_in_schema=False)
