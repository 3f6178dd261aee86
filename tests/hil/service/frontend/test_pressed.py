"""What is pressed twice is done once; an emergency stop that nobody takes is not called sent."""

from __future__ import annotations

import os
import re
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, region, to
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        service.give("short", SHORT)
        yield service


def test_a_double_click_queues_one_run_and_leaves_one_note(page: playwright.Page, there: Served) -> None:
    to(page, there, "plans/short")
    page.get_by_role("button", name="Queue the run").dblclick()
    expect(page).to_have_url(re.compile(r"/runs/1$"))
    there.over(1)
    notes = region(page, "Tags and notes")
    notes.get_by_role("textbox", name="Note").fill("the belt was warm")
    notes.get_by_role("button", name="Add the note").dblclick()
    expect(notes.get_by_text("the belt was warm")).to_have_count(1)
    page.wait_for_timeout(500)
    assert len(there.get("/runs")) == 1
    assert len(there.get("/runs/1/notes")["notes"]) == 1


def test_a_click_on_the_stop_behind_the_palette_stops(page: playwright.Page, there: Served) -> None:
    """The window took the click and closed, and the axle went on."""
    to(page, there, "benches/sim")
    box = page.locator("button.stop").bounding_box()
    assert box is not None
    page.keyboard.press("Control+k")
    expect(page.get_by_role("dialog")).to_be_visible()
    with page.expect_response("**/emergency-stop"):
        page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    expect(page.get_by_role("dialog")).to_have_count(0)
    assert is_stopped(there)


def test_the_tab_key_leads_from_the_palette_to_the_stop(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    expect(page.get_by_role("heading", level=1)).to_be_visible()  # the page listens
    page.keyboard.press("Control+k")
    expect(page.get_by_role("combobox", name="Find a plan")).to_be_focused()
    page.keyboard.press("Tab")
    expect(page.locator("button.stop")).to_be_focused()
    with page.expect_response("**/emergency-stop"):
        page.keyboard.press("Enter")
    assert is_stopped(there)


def test_a_stop_that_nobody_takes_is_not_delivered(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    page.route("**/emergency-stop", lambda _: None)  # never answered
    stop = page.locator("button.stop")
    stop.click()
    expect(stop).to_contain_text("NOT delivered")
    notice = page.get_by_role("alert").filter(has_text="NOT delivered")
    expect(notice).to_contain_text(re.compile("does not answer. It is tried again until .* Use the stop at"))


def test_a_stop_that_the_stop_post_alone_has_taken_says_that_the_service_stands_still(
    page: playwright.Page, there: Served
) -> None:
    """The button said 'sent' for a moment, and the page went on as if nothing had happened."""
    to(page, there, "benches/sim")
    page.wait_for_timeout(500)  # the page knows the stop post
    os.kill(there.process.pid, signal.SIGSTOP)
    try:
        page.locator("button.stop").click()
        notice = page.get_by_role("alert").filter(has_text="The service does not answer")
        expect(notice).to_contain_text(
            re.compile("was delivered at .*: tests are being stopped.*Look at the bench")
        )
        expect(page.locator("button.stop")).to_contain_text("delivered")
        assert latches_of(there)
        page.wait_for_timeout(1500)
    finally:
        os.kill(there.process.pid, signal.SIGCONT)
    expect(notice).to_have_count(0)
    rows = [row["detail"] for row in there.get("/audit") if row["action"] == "emergency stop"]
    assert any("asked for at" in detail for detail in rows)


def is_stopped(there: Served) -> bool:
    """Once the service has heard of a stop that its stop post took."""
    for _ in range(100):
        if there.get("/benches/sim")["state"] == "emergency_stop":
            return True
        time.sleep(0.05)
    return False


def latches_of(there: Served) -> list[Path]:
    """Stops on the service's disk, once there is one."""
    for _ in range(100):
        if found := list((there.data / "emergency-stops").glob("*.json")):
            return found
        time.sleep(0.05)
    return []


def test_a_stop_that_nobody_has_taken_in_ten_minutes_is_not_tried_any_longer(
    page: playwright.Page, there: Served
) -> None:
    page.clock.install()
    to(page, there, "benches/sim")
    page.route("**/emergency-stop", lambda _: None)
    page.locator("button.stop").click()
    notice = page.get_by_role("alert").filter(has_text="NOT delivered")
    page.clock.run_for(1100)
    expect(notice).to_contain_text("It is tried again until")
    page.clock.run_for(31_000)
    expect(notice).to_contain_text("It is tried again until")
    page.clock.run_for(570_000)
    expect(notice).to_contain_text(
        re.compile("did not answer. It has not been tried since .* Use the stop at")
    )
    notice.get_by_role("button", name="Hide this message").click()
    expect(notice).to_have_count(0)
    page.unroute("**/emergency-stop")
    with page.expect_response("**/emergency-stop"):
        page.locator("button.stop").click()  # and the next one is taken
    page.clock.run_for(1100)
    expect(notice).to_have_count(0)
    assert is_stopped(there)


@pytest.mark.parametrize("refusals", [("403 (Forbidden)", "401 (Unauthorized)")])
def test_a_stop_that_the_service_refuses_says_so_and_why(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    why = {"what": "the request comes from another site's page", "where": "", "fix": ""}
    page.route("**/emergency-stop", lambda route: route.fulfill(status=403, json=why))
    page.locator("button.stop").click()
    notice = page.get_by_role("alert").filter(has_text="NOT delivered")
    expect(notice).to_contain_text("the service refused it at")
    expect(notice).to_contain_text("the request comes from another site's page")
    expect(page.get_by_role("alert")).to_have_count(1)
