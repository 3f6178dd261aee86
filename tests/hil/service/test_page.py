"""The page is one document at every address but the API's, with parts that a browser may keep for good."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
from fastapi import FastAPI

from hil.service.api import _page
from hil.service.api._problems import answer_problems


@dataclass
class Answered:
    status: int = 0
    headers: dict[str, str] = field(default_factory=dict)
    body: str = ""


@pytest.fixture
def built(tmp_path: Path) -> Path:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<!doctype html><title>page</title>")
    (tmp_path / "assets/index-1a2b.js").write_text("export {}")
    (tmp_path / "icon.svg").write_text("<svg/>")
    return tmp_path


def get(folder: Path, address: str) -> Answered:
    app = FastAPI()
    _page.add_to(app, folder)
    answer_problems(app)
    return asyncio.run(_asked(app, address))


async def _asked(app: FastAPI, address: str) -> Answered:
    found = Answered()

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Any) -> None:
        if message["type"] == "http.response.start":
            found.status = message["status"]
            found.headers = {name.decode(): value.decode() for name, value in message["headers"]}
        else:
            found.body += message.get("body", b"").decode()

    path, _, query = address.partition("?")
    scope = {"type": "http", "method": "GET", "path": unquote(path), "raw_path": path.encode()}
    await app(
        {**scope, "query_string": query.encode(), "headers": [], "http_version": "1.1", "scheme": "http"},
        receive,
        send,
    )
    return found


@pytest.mark.parametrize("address", ["/", "/runs/17", "/benches/a%20b/panel", "/nothing", "/apples"])
def test_every_address_gives_the_document(built: Path, address: str) -> None:
    answer = get(built, address)
    assert answer.status == 200
    assert answer.headers["content-type"].startswith("text/html")
    assert "<title>page</title>" in answer.body


def test_what_the_api_does_not_know_is_no_view(built: Path) -> None:
    for address in ("/api/v1/nothing", "/api/"):
        answer = get(built, address)
        assert (answer.status, json.loads(answer.body)["what"]) == (404, "Not Found")


@pytest.mark.parametrize(
    ("former", "now"),
    [
        ("/app", "/"),
        ("/app/runs/17", "/runs/17"),
        ("/app/runs?plan=a,b", "/runs?plan=a,b"),
        ("/app//evil.example", "/evil.example"),
    ],
)
def test_an_address_from_when_there_were_two_pages_leads_to_the_same_view(
    built: Path, former: str, now: str
) -> None:
    answer = get(built, former)
    assert (answer.status, answer.headers["location"]) == (308, now)


def test_icon_and_colours_come_from_the_service(built: Path) -> None:
    assert get(built, "/icon.svg").headers["content-type"].startswith("image/svg+xml")
    colours = get(built, "/colours.css")
    assert colours.headers["content-type"].startswith("text/css")
    assert '[data-theme="dark"]' in colours.body


def test_a_part_is_kept_for_good_and_the_document_is_not(built: Path) -> None:
    part = get(built, "/assets/index-1a2b.js")
    assert part.headers["content-type"].startswith("text/javascript")
    assert "immutable" in part.headers["cache-control"]
    assert "cache-control" not in get(built, "/").headers  # the guard's: nothing is kept


def test_a_part_of_an_earlier_build_is_not_the_document(built: Path) -> None:
    answer = get(built, "/assets/index-old.js")
    assert answer.status == 404
    assert "load the page again" in json.loads(answer.body)["fix"]


def test_no_name_leads_out_of_the_parts(built: Path) -> None:
    for name in ("../index.html", "%2e%2e%2findex.html", "..%2F..%2F..%2Fpyproject.toml"):
        answer = get(built, f"/assets/{name}")
        assert answer.status == 404 or "<title>page</title>" in answer.body


def test_without_a_build_the_page_says_what_to_do(tmp_path: Path) -> None:
    answer = get(tmp_path, "/runs")
    assert (answer.status, json.loads(answer.body)["fix"]) == (503, "make page")
