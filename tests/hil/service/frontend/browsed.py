"""What tests of the page in a browser have in common."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.served import Served

_ROOT = Path(__file__).parents[4]
BUILT = pytest.mark.skipif(
    not (_ROOT / "hil/service/frontend/built/index.html").is_file(), reason="the page is not built: make page"
)
#: For modules of such tests.
IN_A_BROWSER = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium"),
    BUILT,
]
expect = playwright.expect
expect.set_options(timeout=60_000)


def to(page: playwright.Page, there: Served, address: str) -> None:
    """Open an address of the page."""
    page.goto(f"{there.url}/{address}")


def heading(page: playwright.Page, name: str | re.Pattern[str]) -> playwright.Locator:
    """The heading that says what a view is of."""
    return page.get_by_role("heading", level=1, name=name)


def region(page: playwright.Page, name: str) -> playwright.Locator:
    """A part of a view, by its heading."""
    return page.get_by_role("region", name=name, exact=True)


def answer(page: playwright.Page, button: str) -> None:
    """Press a button of the question that the page asks."""
    asked = page.get_by_role("alertdialog")
    asked.get_by_role("button", name=button, exact=True).click()
    expect(asked).to_have_count(0)


def reset_stop(
    page: playwright.Page,
    there: Served,
    within: playwright.Locator,
    button: str = "It is safe: reset the emergency stop",
) -> None:
    """Reset the emergency stop of the bench sim, of which the axle stands."""
    within.get_by_role("button", name=button).click()
    asked = page.get_by_role("alertdialog")
    for _ in range(200):  # a look that is some seconds old is asked about
        if there.get("/benches/sim")["state"] != "emergency_stop":
            return
        if asked.is_visible():
            answer(page, "It stands still: reset")
        page.wait_for_timeout(100)
    pytest.fail("the stop was not reset")


def choice(page: playwright.Page, name: str) -> playwright.Locator:
    """A list to choose from, by what stands before it."""
    return page.get_by_role("combobox", name=name, exact=True)
