"""One service for all tests that leave it as they found it, a browser, and a server of PostgreSQL."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright
from sqlalchemy import Engine

from hil.service.store import BenchStore, open_database
from tests.hil.service import served as served_by
from tests.hil.service.postgresql import Cluster, cluster
from tests.hil.service.served import ASKING, SHORT, Served, served


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Where slow tests are left out: its calls are thought of while tests are collected, half a minute."""
    slow_ones = collection_path.name == "test_api_fuzz.py"
    return True if slow_ones and "not slow" in config.getoption("markexpr") else None


@pytest.fixture(scope="session")
def postgresql() -> Iterator[Cluster]:
    with cluster() as server:
        yield server


@pytest.fixture(scope="session", autouse=True)
def _database(request: pytest.FixtureRequest) -> None:
    """With HIL_SERVICE_DATABASE=postgresql every service has a database of this server."""
    if served_by.ON_POSTGRESQL:
        served_by.new_database = request.getfixturevalue("postgresql").database


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """A new database of either kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'service.sqlite'}"
    server: Cluster = request.getfixturevalue("postgresql")
    return server.database()


@pytest.fixture
def engine(url: str) -> Iterator[Engine]:
    engine = open_database(url)
    BenchStore(engine, "me").hold("sim")
    yield engine
    engine.dispose()


@pytest.fixture(scope="package")
def service(_database: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("service")
    with served(folder / "data", state=folder / "state") as one:
        one.give("short", SHORT)
        one.give("asking", ASKING)
        yield one


@pytest.fixture
def browser() -> Iterator[playwright.Browser]:
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def locale() -> str:
    """The language that the browser prefers; tests of others say theirs as a parameter."""
    return "en-US"


@pytest.fixture
def refusals() -> tuple[str, ...]:
    """Statuses that a page meets as it should; a browser reports each. Tests of others name theirs."""
    return ("401 (Unauthorized)",)  # asking who one is


@pytest.fixture
def page(
    there: Served, browser: playwright.Browser, locale: str, refusals: tuple[str, ...]
) -> Iterator[playwright.Page]:
    page = browser.new_page(viewport={"width": 1280, "height": 900}, locale=locale)
    troubles: list[str] = []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.on("console", lambda line: troubles.append(_trouble(line)) if line.type == "error" else None)
    page.on("request", lambda request: _refuse_elsewhere(request.url, there.url, troubles))
    page.set_default_timeout(60_000)
    yield page
    page.close()
    assert [one for one in troubles if not any(status in one for status in refusals)] == []


def _trouble(line: playwright.ConsoleMessage) -> str:
    return f"{line.text} {line.location['url']}"


def _refuse_elsewhere(url: str, home: str, troubles: list[str]) -> None:
    if not url.startswith(("http://127.0.0.1:", "data:", "blob:")):
        troubles.append(f"asked elsewhere: {url} from {home}")
