"""What the page asks before it does something: in a window of its own, above which the stop works."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, expect, heading, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
_FOCUSED = "document.activeElement.textContent.trim()"


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        service.give("short", SHORT)
        yield service


@pytest.fixture
def asked(page: playwright.Page, there: Served) -> playwright.Locator:
    """The question whether a plan is to be removed, while it is open; a window of the browser's fails."""
    page.on("dialog", lambda dialog: pytest.fail(f"the browser asks by itself: {dialog.message}"))
    to(page, there, "plans/short")
    page.get_by_role("button", name="Remove the plan").click()
    question = page.get_by_role("alertdialog", name="Remove the plan short? Its runs stay.")
    expect(question).to_be_visible()
    return question


@pytest.mark.parametrize("width", [1280, 390])
def test_a_click_on_the_stop_while_the_page_asks_stops_the_bench(
    page: playwright.Page, there: Served, asked: playwright.Locator, width: int
) -> None:
    page.set_viewport_size({"width": width, "height": 844})
    box = page.locator("button.stop").bounding_box()
    assert box is not None
    with page.expect_response("**/emergency-stop"):
        page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    expect(asked).to_have_count(0)  # what was asked before a stop is asked anew
    assert there.get("/benches/sim")["state"] == "emergency_stop"
    assert "short" in [plan["name"] for plan in there.get("/plans")]


def test_the_stop_is_found_by_keyboard_while_the_page_asks(
    page: playwright.Page, there: Served, asked: playwright.Locator
) -> None:
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Find a plan").fill("emergency stop")
    with page.expect_response("**/emergency-stop"):
        page.keyboard.press("Enter")
    expect(asked).to_have_count(0)
    assert there.get("/benches/sim")["state"] == "emergency_stop"


def test_keys_reach_the_question_and_the_stop_alone(page: playwright.Page, asked: playwright.Locator) -> None:
    expect(asked.get_by_role("button", name="Cancel")).to_be_focused()  # what changes nothing
    refuse_hard_to_use(page)
    reached = set()
    for _ in range(8):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(_FOCUSED) if page.evaluate("document.activeElement !== document.body") else ""
        )
    assert reached - {""} == {"Remove", "Cancel", "Emergency stop all benches"}
    page.keyboard.press("Escape")
    expect(asked).to_have_count(0)
    expect(page.get_by_role("button", name="Remove the plan")).to_be_focused()  # where one was before
    expect(heading(page, "short")).to_be_visible()


def test_what_is_agreed_to_is_done_and_the_page_is_in_reach_again(
    page: playwright.Page, there: Served, asked: playwright.Locator
) -> None:
    answer(page, "Remove")
    expect(heading(page, "Plans")).to_be_visible()
    assert "short" not in [plan["name"] for plan in there.get("/plans")]
    page.get_by_role("link", name="Runs", exact=True).first.click()
    expect(heading(page, "Runs")).to_be_visible()
    assert page.locator("[inert]").count() == 0
