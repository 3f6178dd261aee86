"""A page whose token is revoked, or that is signed out in another tab, offers to sign in."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.service.serving import make_token
from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import Served, environment_of, served

pytestmark = IN_A_BROWSER
_ENDED = "You are no longer signed in"


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    data = tmp_path / "data"
    secret = make_token(data, environment_of(data)["HIL_DATABASE"], "anna", "admin").secret
    with served(data, state=tmp_path / "state", token=secret) as service:
        yield service


def _enter(page: playwright.Page, there: Served, secret: str) -> None:
    to(page, there, "benches/sim")
    page.get_by_label("Token").fill(secret)
    page.get_by_role("button", name="Sign in").click()
    expect(heading(page, "Bench sim Free")).to_be_visible()


def test_a_revoked_token_shows_no_bench_any_more(page: playwright.Page, there: Served) -> None:
    made = there.post("/tokens", {"name": "bert", "role": "viewer"})
    _enter(page, there, made["secret"])
    there.ask("DELETE", f"/api/v1/tokens/{made['token']['id']}")
    expect(heading(page, "Sign in")).to_be_visible()
    expect(page.get_by_role("alert")).to_have_count(1)
    expect(page.get_by_role("alert")).to_contain_text(_ENDED)
    expect(page.get_by_text("bert")).to_have_count(0)
    refuse_hard_to_use(page)
    page.get_by_label("Token").fill(there.token)
    page.get_by_role("button", name="Sign in").click()
    expect(heading(page, "Bench sim Free")).to_be_visible()
    expect(page.get_by_text("anna, admin")).to_be_visible()


def test_signing_out_in_one_tab_ends_the_other(page: playwright.Page, there: Served) -> None:
    _enter(page, there, there.token)
    with page.expect_popup() as opened:
        page.evaluate("() => { window.open('/benches'); }")
    other = opened.value
    other.get_by_role("button", name="Sign out").click()
    expect(heading(other, "Sign in")).to_be_visible()
    expect(other.get_by_text(_ENDED)).to_have_count(0)  # it was asked for here
    expect(heading(page, "Sign in")).to_be_visible()
    expect(page.get_by_role("alert")).to_contain_text(_ENDED)
    other.close()


def test_what_is_pressed_after_the_end_leads_to_the_sign_in(page: playwright.Page, there: Served) -> None:
    """A view without live values asks nothing by itself for a while."""
    _enter(page, there, there.token)
    to(page, there, "settings")
    expect(heading(page, "Settings")).to_be_visible()
    page.context.clear_cookies()
    page.get_by_role("link", name="Plans", exact=True).click()
    expect(heading(page, "Sign in")).to_be_visible()
    expect(page.get_by_text("Authorization: Bearer")).to_have_count(0)


@pytest.mark.parametrize("refusals", [("401 (Unauthorized)", "422 (Unprocessable")])
def test_what_cannot_be_a_token_is_refused_as_a_token(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    page.get_by_label("Token").fill("no token ä")
    page.get_by_role("button", name="Sign in").click()
    alert = page.get_by_role("alert")
    expect(alert).to_contain_text("this token is not known, has expired or was revoked")
    expect(alert).not_to_contain_text("secret")
