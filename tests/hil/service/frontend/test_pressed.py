"""What is pressed twice is done once; an emergency stop that nobody takes is not called sent."""

from __future__ import annotations

import re
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


def test_a_stop_that_nobody_takes_is_not_delivered(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    page.route("**/emergency-stop", lambda _: None)  # never answered
    stop = page.locator("button.stop")
    stop.click()
    expect(stop).to_contain_text("NOT delivered")
    expect(page.get_by_role("alert").filter(has_text="NOT delivered")).to_be_visible()
