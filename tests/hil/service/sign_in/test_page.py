"""Somebody signs in at the provider's own page, and comes back to the view that was asked for."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.service.serving import make_token
from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import Served, environment_of, served
from tests.hil.service.sign_in.conftest import SECRET_ENV
from tests.hil.service.sign_in.provider import AnyProvider, provider

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def identities() -> Iterator[AnyProvider]:
    with provider() as one:
        one.add("anna", name="Anna Berg", groups=["lab"])
        one.add("guest", name="A guest", groups=[])
        yield one


@pytest.fixture
def there(identities: AnyProvider, tmp_path: Path) -> Iterator[Served]:
    """On a port that is known beforehand: the provider sends people back to the address in the settings."""
    data, port = tmp_path / "data", _free_port()
    secret = make_token(data, environment_of(data)["HIL_DATABASE"], "root", "admin").secret
    settings = tmp_path / "sign-in.toml"
    settings.write_text(
        f'name = "the laboratory"\nissuer = "{identities.url}"\nclient_id = "bench"\n'
        f'client_secret_env = "{SECRET_ENV}"\naddress = "http://127.0.0.1:{port}"\n'
        '[roles]\nlab = "operator"\n'
    )
    options = ("--port", str(port), "--sign-in", str(settings))
    with served(data, *options, state=tmp_path / "state", token=secret) as service:
        yield service


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


def _sign_in(page: playwright.Page, subject: str) -> None:
    page.get_by_role("link", name="Sign in with the laboratory").click()
    page.get_by_role("textbox").first.fill(subject)
    page.keyboard.press("Enter")


def test_one_signs_in_with_the_provider(page: playwright.Page, there: Served) -> None:
    page.goto(f"{there.url}/benches/sim?x=1")
    expect(heading(page, "Sign in")).to_be_visible()
    link = page.get_by_role("link", name="Sign in with the laboratory")
    expect(link).to_be_visible()
    _sign_in(page, "guest")
    expect(page.get_by_role("alert")).to_contain_text("none of your groups has a role here")
    assert "sign_in" not in page.url
    page.goto(f"{there.url}/benches/sim?x=1")
    _sign_in(page, "anna")
    expect(page.get_by_text("Anna Berg, operator")).to_be_visible()
    assert page.url == f"{there.url}/benches/sim?x=1"
    page.reload()
    expect(page.get_by_text("Anna Berg, operator")).to_be_visible()
    page.get_by_role("button", name="Sign out").click()
    expect(heading(page, "Sign in")).to_be_visible()
    page.reload()
    page.get_by_text("Sign in with a token").click()
    page.get_by_label("Token").fill(there.token)
    page.get_by_role("button", name="Sign in").click()
    expect(page.get_by_text("root, admin")).to_be_visible()


def test_the_view_is_easy_to_use(page: playwright.Page, there: Served) -> None:
    page.goto(f"{there.url}/?sign_in=declined")
    expect(page.get_by_role("link", name="Sign in with the laboratory")).to_be_visible()
    refuse_hard_to_use(page)
