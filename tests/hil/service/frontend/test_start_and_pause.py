"""Values typed into the form that starts a plan, a run that is paused, and how both are found."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, to
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
_SLOW = SHORT.replace("name: short", "name: slow\ntitle: Tip-in with 200 N m").replace(
    "steps:",
    "steps:" + 90 * "\n  - wait: {duration_s: 1}",  # a pause begins between two steps
    1,
)


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("start")
    with served(folder / "data", "--rate", "1", state=folder / "state") as service:
        service.give("short", SHORT)
        service.give("slow", _SLOW)
        yield service


def test_a_decimal_comma_is_kept_on_the_german_page_of_an_english_browser(
    page: playwright.Page, there: Served
) -> None:
    page.add_init_script("localStorage.setItem('language', 'de')")
    to(page, there, "plans/short")
    value = page.get_by_role("textbox", name="torque_nm in N m")
    queue = page.get_by_role("button", name="Lauf einreihen")
    expect(page.locator(".forecast")).to_contain_text("Größtes angefordertes Drehmoment")
    before = queue.bounding_box()
    value.fill("")
    expect(page.locator(".forecast")).to_contain_text("torque_nm in N m: Das Feld ist leer")
    expect(queue).to_be_disabled()
    with page.expect_request(
        lambda asked: asked.url.endswith("/forecasts") and asked.post_data_json["values"]["torque_nm"] == 20.5
    ):
        value.press_sequentially("20,5")
    expect(page.locator(".forecast")).to_contain_text("Passt", timeout=180_000)
    expect(page.locator(".forecast")).not_to_contain_text("Größtes angefordertes")
    assert queue.bounding_box() == before
    queue.click()
    expect(page.locator(".facts")).to_contain_text("torque_nm = 20,5")
    there.over(int(page.url.rpartition("/")[2]))


def test_a_paused_run_is_headed_so_and_answered_by_its_buttons_and_found_by_its_words(
    page: playwright.Page, there: Served
) -> None:
    run = there.queue("slow")
    to(page, there, "benches/sim")
    expect(heading(page, re.compile("Running: Tip-in"))).to_be_visible()
    page.get_by_role("button", name="Pause").click()
    expect(heading(page, re.compile("Paused: Tip-in"))).to_be_visible(timeout=30_000)
    banner = page.get_by_role("region", name="State of sim")
    expect(banner).to_contain_text("or with Resume")
    expect(banner).to_contain_text("paused by the operator")
    expect(banner).not_to_contain_text("Enter")
    expect(banner.get_by_label("Answer")).to_have_count(0)
    for words in ("Tip-in with 200", "200 N m", "tip 200"):
        page.keyboard.press("Control+k")
        page.keyboard.type(words)
        expect(page.get_by_role("option", name=re.compile(f"Run {run}"))).to_be_visible()
        page.keyboard.press("Escape")
    banner.get_by_role("button", name="Resume").click()
    expect(heading(page, re.compile("Running: Tip-in"))).to_be_visible(timeout=30_000)
    expect(banner).not_to_contain_text("held")
    banner.get_by_role("button", name="End the run").click()
    there.over(run)
