"""What keeps a form from being sent is said at its field by the page, in the page's language."""

from __future__ import annotations

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import Served

pytestmark = IN_A_BROWSER
#: Whether the browser is kept from saying it, too.
_WATCH = "addEventListener('invalid', (event) => { window.kept = event.defaultPrevented; }, true)"


@pytest.fixture
def there(service: Served) -> Served:
    return service


def test_a_tag_that_is_none_is_refused_at_its_field(page: playwright.Page, there: Served) -> None:
    there.over(run := there.queue())
    to(page, there, f"runs/{run}")
    notes = region(page, "Tags and notes")
    tag = notes.get_by_role("combobox", name="Tag")
    expect(tag).to_be_visible()
    page.evaluate(_WATCH)
    notes.get_by_role("button", name="Add", exact=True).click()
    message = page.get_by_role("alert")
    expect(message).to_have_text("This field is empty.")
    expect(tag).to_be_focused()
    expect(tag).to_have_attribute("aria-describedby", "field-message")
    assert page.evaluate("window.kept")
    tag.fill("two words")
    expect(message).to_have_count(0)
    page.keyboard.press("Enter")
    expect(message).to_have_text("Allowed are letters, digits, _ . : and -, and first a letter or a digit.")
    box, below = tag.bounding_box(), message.bounding_box()
    assert box is not None
    assert below is not None
    assert 0 <= below["y"] - (box["y"] + box["height"]) < 20
    page.set_viewport_size({"width": 390, "height": 844})  # its place has moved
    expect(message).to_have_count(0)
    page.keyboard.press("Enter")
    expect(message).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    tag.fill("")
    refuse_hard_to_use(page)


@pytest.mark.parametrize("locale", ["en-US"])
def test_half_a_date_is_refused_in_the_language_of_the_page(page: playwright.Page, there: Served) -> None:
    page.add_init_script("localStorage.setItem('language', 'de')")
    to(page, there, "runs")
    first = page.get_by_label("Von", exact=True)
    first.click()
    page.keyboard.type("12")
    page.get_by_label("Wörter", exact=True).click()
    message = page.get_by_role("alert")
    expect(message).to_have_text("Das ist kein vollständiges Datum.")
    refuse_hard_to_use(page)
    first.fill("2026-11-28")
    expect(message).to_have_count(0)
    page.get_by_label("Bis", exact=True).fill("2026-11-20")
    expect(message).to_contain_text("kein Lauf")
