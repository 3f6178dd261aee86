"""The HTML report as a browser shows it: nothing scrolls sideways but wide tables and texts of files."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from playwright import sync_api as playwright

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium"),
]
#: A window of 1000 px with a scroll bar leaves 985.
WIDTHS = (1280, 1000, 985, 820, 700, 390, 320)
_OUTSIDE = """width => [...document.querySelectorAll("body *")]
  .filter((one) => one.getBoundingClientRect().right > width + 0.5 && !one.closest(".scroll, pre, .plot"))
  .map((one) => `${one.tagName}.${one.className}: ${one.textContent.slice(0, 40)}`)"""
_HIDDEN_LINKS = "all => all.map((one) => one.scrollWidth - one.clientWidth)"


def test_the_report_and_the_links_under_its_title_fit_into_every_width(acceptance: dict[str, Path]) -> None:
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        found = {}
        for width in WIDTHS:
            page = browser.new_page(viewport={"width": width, "height": 900})
            page.goto(acceptance["html"].resolve().as_uri())
            wide = page.evaluate("document.documentElement.scrollWidth") > width
            found[width] = (wide, page.evaluate(_OUTSIDE, width))
            assert max(page.locator("nav ul").evaluate_all(_HIDDEN_LINKS)) <= 0
            page.close()
        browser.close()
    assert found == {width: (False, []) for width in WIDTHS}
