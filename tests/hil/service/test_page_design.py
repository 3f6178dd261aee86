"""A controller is moved by hand on the page, saved, and used in a run."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.core.controller import load_controller
from tests.hil.service.looks import refuse_hard_to_use, roles_drawn
from tests.hil.service.served import SHORT, Served, environment_of, served

playwright.expect.set_options(timeout=60_000)  # the first draft waits for a process to begin
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium"),
]
_MEASURED = "performance.getEntriesByName('drafted').map((one) => one.duration)"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("design")
    with served(folder / "data", state=folder / "state") as service:
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        yield service


def test_what_is_moved_is_followed_saved_and_run(
    page: playwright.Page, there: Served, tmp_path: Path
) -> None:
    page.goto(there.url)
    expect = playwright.expect
    page.locator("#design > summary").click()
    figures = page.locator("#design-figures")
    expect(figures).to_contain_text("peak of T_s at 20 km/h")
    page.locator("#design-model").select_option("three_inertia")
    expect(figures).to_contain_text("1.434")
    for canvas in ("nyquist", "sensitivity", "step-slow", "step-fast"):
        assert "gain" in roles_drawn(page, canvas, ("gain",)), canvas
    _moves_and_is_followed(page)
    page.locator("#lead-deg").fill("30")
    expect(figures).to_contain_text("1.549")
    expect(page.locator("#lead-deg-slide")).to_have_value("30")
    page.locator("#pole-rad-s").fill("60")
    expect(page.locator("#design-stable")).to_have_text("unstable")
    expect(page.locator("#design-unstable")).to_contain_text("outside the unit circle")
    page.locator("#pole-rad-s").fill("0.3")
    expect(page.locator("#design-stable")).to_have_text("stable")
    page.locator("#design-name").fill("softer")
    page.get_by_role("button", name="Save the controller").click()
    expect(page.locator("#design-message")).to_contain_text("Saved as softer")
    with page.expect_download() as download:
        page.get_by_role("button", name="Download controller.toml").click()
    download.value.save_as(tmp_path / "controller.toml")
    assert load_controller(tmp_path / "controller.toml").name == "softer"
    page.locator("#design-plan").select_option("short")
    page.get_by_role("button", name="Make the plan").click()
    expect(page.get_by_label("Plan", exact=True)).to_have_value("short-softer")
    button = page.get_by_role("button", name="Queue the run")
    expect(button).to_be_enabled(timeout=180_000)
    button.click()
    row = page.locator("#results tbody tr").first
    expect(row).to_contain_text("A short plan, short-softer", timeout=60_000)
    expect(row).to_contain_text("pass")


def _moves_and_is_followed(page: playwright.Page) -> None:
    """Tells the time from a slider's key to what is drawn, which hangs on what else the machine does."""
    slider = page.get_by_label("Lead P h in °, slider")
    slider.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_timeout(1000)
    page.evaluate("performance.clearMeasures('drafted')")
    for key in ("ArrowRight", "ArrowLeft") * 10:
        page.keyboard.press(key)
        page.wait_for_timeout(60)
    page.wait_for_timeout(500)
    took_ms = sorted(page.evaluate(_MEASURED))
    print(f"from input to drawn: median {took_ms[len(took_ms) // 2]:.0f} ms, most {took_ms[-1]:.0f} ms")
    assert len(took_ms) >= 3  # how many of twenty are skipped is the machine's affair
    expect = playwright.expect
    expect(page.locator("#lead-deg")).to_have_value("36.5")
    last = page.locator("#design-figures").inner_text()
    page.locator("#lead-deg").fill("36.5")
    page.wait_for_timeout(300)
    assert page.locator("#design-figures").inner_text() == last  # what was drawn last is of the last input


def test_a_notch_has_its_own_numbers_and_all_is_easy_to_use(page: playwright.Page, there: Served) -> None:
    page.goto(there.url)
    expect = playwright.expect
    expect(page.get_by_role("heading", name="Free")).to_be_visible()
    page.locator("#design > summary").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#design-figures")).to_contain_text("gain margin")
    page.get_by_label("Stabilisation").select_option("gain")
    expect(page.locator("#lead-deg")).to_be_hidden()
    expect(page.locator("#notch-hz")).to_have_attribute("placeholder", re.compile(r"1[01]\.\d\d"))
    figures = page.locator("#design-figures tbody")
    before = figures.inner_text()
    page.locator("#notch-hz").fill("14")
    expect(figures).not_to_have_text(before, use_inner_text=True)
    refuse_hard_to_use(page)


def test_a_viewer_designs_nothing(page: playwright.Page, tmp_path: Path) -> None:
    from hil.service.serving import make_token

    database = environment_of(tmp_path / "data")["HIL_DATABASE"]
    made = make_token(tmp_path / "data", database, "anna", "viewer")
    with served(tmp_path / "data", state=tmp_path / "state", token=made.secret) as service:
        page.goto(service.url)
        page.get_by_label("Token").fill(made.secret)
        page.get_by_role("button", name="Log in").click()
        playwright.expect(page.get_by_role("heading", name="Free")).to_be_visible()
        assert page.locator("#design").is_hidden()
        page.goto("about:blank")  # it would tell that the service has gone
