"""The page in a browser, against the real service on the simulated bench."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.served import ASKING, SHORT, Served, environment_of, served
from tests.readers.tools import NotHereError, node_modules

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium"),
]
#: Time enough before its question for all that was measured to be written.
_LATER = ASKING.replace("name: asking", "name: asking\ntitle: A plan that asks").replace(
    "  - operator_prompt", "  - wait: {duration_s: 5}\n  - operator_prompt"
)


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("page")
    with served(folder / "data", state=folder / "state") as service:
        service.give("asking", _LATER)
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        yield service


def test_a_plan_is_foreseen_queued_watched_stopped_and_found(page: playwright.Page, there: Served) -> None:
    page.goto(there.url)
    expect = playwright.expect
    expect.set_options(timeout=60_000)
    page.get_by_label("Plan", exact=True).select_option("asking")
    expect(page.locator("#forecast")).to_contain_text("Fits the bench", timeout=180_000)
    expect(page.locator("#forecast")).to_contain_text("motor_speed_rad_s")
    page.get_by_role("button", name="Queue the run").click()
    expect(page.get_by_role("heading", name="Running: A plan that asks")).to_be_visible()
    expect(page.locator("#message")).to_contain_text("Is the cage shut?")
    expect(page.locator("#now-speed")).to_contain_text("rad/s, limit ±700")
    expect(page.locator("#criteria")).to_contain_text("s.peak_shaft_torque")
    page.get_by_role("button", name="Emergency stop", exact=True).click()
    expect(page.get_by_role("heading", name="Emergency stop")).to_be_visible()
    row = page.locator("#results tbody tr").first
    expect(row).to_contain_text("error")
    expect(row).to_contain_text("safe")
    expect(page.locator("#trend-figures")).to_contain_text("N m, limit ≤ 400")
    with page.expect_navigation():
        row.get_by_role("link", name="report of run").click()
    expect(page.get_by_role("heading", level=1)).to_contain_text("A plan that asks")
    page.goto(there.url)
    page.get_by_role("button", name="It is safe: reset the emergency stop").click()
    expect(page.get_by_role("heading", name="Free")).to_be_visible()


def test_a_run_is_queued_and_ended_by_keyboard_alone(page: playwright.Page, there: Served) -> None:
    page.goto(there.url)
    expect = playwright.expect
    plan = page.get_by_label("Plan", exact=True)
    expect(plan).to_contain_text("A plan that asks")
    plan.focus()
    page.keyboard.press("Home")
    while plan.input_value() != "asking":  # not by its letters: a slow machine takes them for several words
        page.keyboard.press("ArrowDown")
    button = page.get_by_role("button", name="Queue the run")
    expect(button).to_be_enabled(timeout=180_000)
    page.keyboard.press("Tab")
    while not button.evaluate("one => one === document.activeElement"):
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    end = page.get_by_role("button", name="End the run")
    expect(page.locator("#message")).to_contain_text("Is the cage shut?", timeout=60_000)
    end.focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name="Free")).to_be_visible(timeout=60_000)
    expect(page.locator("#results tbody tr").first).to_contain_text("stopped by the operator")


def test_a_service_without_news_is_not_taken_for_lost(page: playwright.Page, there: Served) -> None:
    page.goto(there.url)
    playwright.expect(page.get_by_role("heading", name="Free")).to_be_visible()
    page.wait_for_timeout(18_000)  # more than the page waits for a word
    playwright.expect(page.locator("#lost")).to_be_hidden()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 820, 380])
def test_nothing_is_found_by_axe_and_nothing_is_cut_off(
    page: playwright.Page, there: Served, scheme: str, width: int
) -> None:
    try:
        axe = node_modules() / "node_modules/axe-core/axe.min.js"
    except NotHereError as missing:
        pytest.skip(str(missing))
    page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    page.set_viewport_size({"width": width, "height": 900})
    page.goto(there.url)
    playwright.expect(page.locator("#forecast")).to_contain_text("bench time", timeout=180_000)
    page.evaluate(axe.read_text("utf-8"))
    rules = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]}
    found = page.evaluate("rules => axe.run(document, rules)", rules)["violations"]
    assert [(one["id"], [node["html"] for node in one["nodes"]]) for one in found] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    stop = page.get_by_role("button", name="Emergency stop", exact=True)
    page.mouse.wheel(0, 5000)
    assert (
        stop.evaluate("one => one.getBoundingClientRect().top") >= 0.0
    )  # in sight wherever one has scrolled


def test_who_has_no_token_can_stop_and_see_nothing(tmp_path: Path, page: playwright.Page) -> None:
    from hil.service.serving import make_token

    database = environment_of(tmp_path / "data")["HIL_DATABASE"]
    made = make_token(tmp_path / "data", database, "anna", "viewer")
    with served(tmp_path / "data", state=tmp_path / "state", token=made.secret) as service:
        page.goto(service.url)
        playwright.expect(page.get_by_role("heading", name="Log in")).to_be_visible()
        page.get_by_role("button", name="Emergency stop", exact=True).click()
        page.get_by_label("Token").fill(made.secret)
        page.get_by_role("button", name="Log in").click()
        playwright.expect(page.get_by_role("heading", name="Emergency stop")).to_be_visible()
        assert page.get_by_role("button", name="It is safe: reset the emergency stop").is_hidden()
        assert page.get_by_role("heading", name="Start a plan").is_hidden()
        page.goto("about:blank")  # it would tell that the service has gone
