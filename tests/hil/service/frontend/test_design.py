"""Controllers are moved by hand on the page, laid over each other, saved, and used in a run."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.core.controller import load_controller
from hil.service.serving import make_token
from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, heading, region, to
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, environment_of, served

pytestmark = IN_A_BROWSER
#: Milliseconds from an input to the figures that follow it.
_FOLLOWED = """async ([text]) => {
  const input = document.getElementById("lead_deg");
  const table = document.querySelector("section[aria-labelledby=section-figures] table");
  const begun = performance.now();
  const followed = new Promise((done) => new MutationObserver(() => done(performance.now() - begun))
    .observe(table, { subtree: true, characterData: true, childList: true }));
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(input, text);
  input.dispatchEvent(new Event("input", { bubbles: true }));
  return followed;
}"""


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("design")
    with served(folder / "data", state=folder / "state") as service:
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        yield service


def test_what_is_moved_is_followed_saved_and_run(
    page: playwright.Page, there: Served, tmp_path: Path
) -> None:
    to(page, there, "design")
    figures = region(page, "Margins and peaks").locator("table")
    expect(figures).to_contain_text("1.434")  # of three_inertia, which is shown first
    for at in range(4):
        expect_drawn(page.locator("figure.plot").nth(at), "gain")
    took_ms = sorted(page.evaluate(_FOLLOWED, [str(20 + at)]) for at in range(9))
    print(f"from input to figures: median {took_ms[4]:.0f} ms, most {took_ms[-1]:.0f} ms")
    page.locator("#lead_deg").fill("30")
    expect(figures).to_contain_text("1.549")
    expect(page.get_by_label("Lead P h in °, slider")).to_have_value("30")
    page.locator("#pole_rad_s").fill("60")
    expect(figures).to_contain_text("unstable")
    expect(page.get_by_text("outside the unit circle")).to_be_visible()
    page.locator("#pole_rad_s").fill("0.3")
    expect(figures).not_to_contain_text("unstable")
    expect(page).to_have_url(f"{there.url}/design?d=phase,lead_deg:30")
    page.get_by_label("Name", exact=True).fill("softer")
    page.get_by_role("button", name="Save the controller").click()
    expect(page.get_by_text("Saved as softer")).to_be_visible()
    with page.expect_download() as download:
        page.get_by_role("button", name="Download controller.toml").click()
    download.value.save_as(tmp_path / "controller.toml")
    assert load_controller(tmp_path / "controller.toml").name == "softer"
    choice(page, "in the plan").select_option("short")
    page.get_by_role("button", name="Make the plan").click()
    expect(heading(page, re.compile("A short plan, short-softer"))).to_be_visible()
    button = page.get_by_role("button", name="Queue the run")
    expect(button).to_be_enabled(timeout=180_000)
    button.click()
    expect(heading(page, re.compile("A short plan, short-softer pass"))).to_be_visible()


def test_drafts_are_laid_over_each_other_and_stand_in_the_address(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "design?model=three_inertia&d=phase")
    figures = region(page, "Margins and peaks").locator("table")
    expect(figures).to_contain_text("gain margin")
    page.get_by_role("button", name="Add another").focus()
    page.keyboard.press("Enter")
    expect(choice(page, "Stabilisation")).to_have_value("gain")
    expect(page.locator("#lead_deg")).to_be_hidden()
    expect(page.locator("#notch_hz")).to_have_attribute("placeholder", re.compile(r"1[01]\.\d\d"))
    nyquist = page.locator("figure.plot").first
    expect_drawn(nyquist, "gain", "phase", "reference")
    before = figures.inner_text()
    page.locator("#notch_hz").fill("14")
    expect(figures).not_to_have_text(before, use_inner_text=True)
    expect(page).to_have_url(re.compile("d=phase;gain,notch_hz:14$"))
    page.reload()
    expect(figures.locator("thead")).to_contain_text("B notch")
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Leave out A lead").click()
    expect(figures.locator("thead")).not_to_contain_text("lead")


def test_cars_follow_when_the_hand_rests_and_segments_have_their_margins(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "design?model=three_inertia")
    cars = region(page, "A lead on drawn cars")
    expect(cars).to_contain_text("40 cars: vehicle_inertia ±0.1")
    expect(cars.locator("thead")).to_contain_text("worst of 40")
    for at in range(2):  # the worst car is drawn in its own colour
        expect_drawn(page.locator("figure.plot").nth(at), "gain", "measured")
    choice(page, "Cars drawn around the model").select_option("20")
    expect(cars).to_contain_text("20 cars: ")
    page.get_by_text("What differs from car to car").click()
    page.get_by_label("dead time ± ms").fill("6")
    page.get_by_label("dead time ± ms").press("Enter")
    expect(cars).to_contain_text("20 cars: dead time ±6 ms")
    expect(page).to_have_url(re.compile(r"cars=20&spread=dead_time_s:6"))
    before = cars.locator("table").inner_text()
    page.locator("#lead_deg").fill("20")
    expect(cars.locator("table")).not_to_have_text(before, use_inner_text=True)
    segments = region(page, "Margins in the segments of a plan")
    choice(page, "Plan").select_option("take_off_on_low_friction")
    expect(segments.locator("tbody")).to_contain_text("friction 0.05, tyres slide")
    expect(segments.locator("thead")).to_contain_text("with A lead")
    refuse_hard_to_use(page)
    page.reload()
    expect(segments.locator("tbody")).to_contain_text("take_off_ice")
    choice(page, "Cars drawn around the model").select_option("0")
    expect(cars).to_contain_text("No cars are drawn.")


def test_a_viewer_designs_nothing(page: playwright.Page, tmp_path: Path) -> None:
    database = environment_of(tmp_path / "data")["HIL_DATABASE"]
    made = make_token(tmp_path / "data", database, "anna", "viewer")
    with served(tmp_path / "data", state=tmp_path / "state", token=made.secret) as service:
        to(page, service, "design")
        page.get_by_label("Token").fill(made.secret)
        page.get_by_role("button", name="Sign in").click()
        expect(page.get_by_text("Engineers design controllers.")).to_be_visible()
        for address in ("identifications", "diagnoses", "campaigns", "plans", "models", "controllers"):
            to(page, service, address)
            expect(page.get_by_role("heading", level=1)).to_be_visible()
            expect(page.locator("main").get_by_text("Loading")).to_have_count(0)
            expect(page.locator("main form")).to_have_count(0)
        page.goto("about:blank")  # it would tell that the service has gone
