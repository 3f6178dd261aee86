"""Two runs laid over each other on the page."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.looks import refuse_hard_to_use, roles_drawn
from tests.hil.service.served import SHORT, Served, served

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium"),
]

_PEAKS = re.compile(r"shaft_torque_nm of run 1 and run 2 from the step; largest \d+ and \d+ N m")
_ASKED = re.compile(r"driving_torque_ref_nm .* largest 100 and 120 N m")


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("comparison")
    with served(folder / "data", state=folder / "state") as service:
        service.give("short", SHORT)
        for torque_nm in (100, 120):
            service.over(service.queue(values={"torque_nm": torque_nm}))
        yield service


def test_two_runs_are_chosen_by_keyboard_and_laid_over_each_other(
    page: playwright.Page, there: Served
) -> None:
    page.goto(there.url)
    expect = playwright.expect
    expect(page.locator("#results")).to_be_visible()
    page.locator("#compare > summary").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#compare-differences")).to_contain_text("variables.torque_nm.default")
    page.keyboard.press("Tab")
    page.keyboard.press("ArrowDown")  # from run 2, the newest, to run 1
    expect(page.locator("#compare-first")).to_have_value("1")
    expect(page.locator("#compare-second")).to_have_value("2")
    row = page.locator("#compare-differences tbody tr")
    expect(row).to_contain_text("100")
    expect(page.locator("#compare-differences tbody tr td").nth(2)).to_have_text("120")
    expect(page.locator("#compare-criteria")).to_contain_text("+")
    expect(page.locator("#compare-shaft")).to_have_attribute("aria-label", _PEAKS)
    for canvas in ("compare-shaft", "compare-speed", "compare-other"):
        assert roles_drawn(page, canvas, ("gain", "phase")) == {"gain", "phase"}, canvas
    page.get_by_label("Stretch").select_option("whole")
    page.get_by_label("Third channel").select_option("driving_torque_ref_nm")
    expect(page.locator("#compare-other")).to_have_attribute("aria-label", _ASKED)
    refuse_hard_to_use(page)
