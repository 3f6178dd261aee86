"""While the service is away the page shows no bench as free, and it goes on by itself afterwards."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, to
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
_COLOUR = "one => getComputedStyle(one).color"


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        service.give("short", SHORT)
        yield service


def test_a_bench_of_a_service_that_is_away_is_not_shown_as_free(
    browser: playwright.Browser, there: Served
) -> None:
    with browser.new_context(locale="en-US") as context:
        bench, wall = context.new_page(), context.new_page()
        to(bench, there, "benches/sim")
        to(wall, there, "wall")
        state = wall.locator(".wall li.bench .state")
        expect(state).to_have_text("Free")
        headline = bench.locator(".headline")
        expect(headline).to_contain_text("Free")
        green, wall_green = headline.evaluate(_COLOUR), state.evaluate(_COLOUR)
        there.process.kill()
        expect(heading(bench, "Bench sim Last known: Free")).to_be_visible()
        assert headline.evaluate(_COLOUR) != green
        expect(wall.locator("html.stale")).to_have_count(1)
        assert state.evaluate(_COLOUR) != wall_green


@pytest.mark.parametrize("refusals", [("401 (Unauthorized)", "503 (Service Unavailable)")])
def test_a_text_is_checked_again_when_the_service_is_back(page: playwright.Page, there: Served) -> None:
    away = [True]
    refusal = {"what": "the service ends", "where": "", "fix": "ask again when it is up"}
    page.route(
        "**/api/v1/plan-checks",
        lambda route: route.fulfill(status=503, json=refusal) if away[0] else route.continue_(),
    )
    to(page, there, "plans/short")
    page.get_by_role("link", name="Edit", exact=True).click()
    expect(page.get_by_text("the service ends").first).to_be_visible()
    away[0] = False
    expect(page.get_by_text("No mistake was found.")).to_be_visible()
    expect(page.get_by_text("the service ends")).to_have_count(0)
