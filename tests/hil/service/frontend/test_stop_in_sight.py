"""The emergency stop is whole and in sight at every width of a window, beside a long name of a person."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from hil.service.serving import make_token
from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, to
from tests.hil.service.served import SHORT, Served, environment_of, served

pytestmark = IN_A_BROWSER
_WHO = "Maximiliane-Charlotte von Hohenstein-Wallenberg"
_ADDRESSES = ("benches", "benches/sim", "runs", "runs/1", "plans/acceptance", "audit", "settings")
_WIDTHS = range(320, 1281, 24)
#: What of the stop is outside of its button or of the window, and whether the page scrolls sideways.
_OUTSIDE = """() => {
  const stop = document.querySelector("button.stop"), words = document.createRange();
  words.selectNodeContents(stop);
  const box = stop.getBoundingClientRect(), text = words.getBoundingClientRect();
  const page = document.documentElement;
  return [
    text.left >= box.left && text.right <= box.right ? "" : "label out of its button",
    box.left >= 0 && box.right <= page.clientWidth && box.top >= 0 ? "" : "stop out of sight",
    page.scrollWidth > page.clientWidth ? `scrolls to ${page.scrollWidth}` : "",
  ].filter(Boolean).join(", ");
}"""


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with a run, that asks who one is."""
    folder = tmp_path_factory.mktemp("in-sight")
    data = folder / "data"
    secret = make_token(data, environment_of(data)["HIL_DATABASE"], _WHO, "admin").secret
    with served(data, "--rate", "1000", state=folder / "state", token=secret) as service:
        service.give("short", SHORT)
        service.over(service.queue())
        yield service


@pytest.mark.parametrize("locale", ["en-US", "de", "ja"])
def test_the_stop_is_whole_at_every_width_and_no_page_scrolls_sideways(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "benches")
    page.locator("main input").fill(there.token)
    page.locator("main button[type=submit]").click()
    expect(page.locator(".who")).to_contain_text(_WHO)
    found = []
    for address in _ADDRESSES:
        to(page, there, address)
        expect(page.locator("h1").first).to_be_visible()
        expect(page.locator(".who")).to_be_visible()
        for width in _WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            if outside := page.evaluate(_OUTSIDE):
                found.append((address, width, outside))
    assert found == []
