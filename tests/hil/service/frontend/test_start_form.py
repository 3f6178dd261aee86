"""Values typed into the form that starts a plan."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, to
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("start")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT)
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
        lambda asked: asked.url.endswith("/forecasts") and '"torque_nm":20.5' in (asked.post_data or "")
    ):
        value.press_sequentially("20,5")
    expect(page.locator(".forecast")).to_contain_text("Passt", timeout=180_000)
    expect(page.locator(".forecast")).to_contain_text("Größtes angefordertes Drehmoment: 20,5\xa0N\xa0m")
    assert queue.bounding_box() == before
    queue.click()
    expect(page.locator(".facts")).to_contain_text("torque_nm = 20,5")
    there.over(int(page.url.rpartition("/")[2]))
