"""The operator's panel by touch, and the wall of the control room."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import ASKING, SHORT, Served, served

pytestmark = IN_A_BROWSER
_SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="30"><circle r="9" fill="red"/></svg>'
_ASKING = ASKING.replace("name: asking", "name: asking\ntitle: A plan that asks").replace(
    "{text: 'Is the cage shut?'}", "{text: 'Is the cage shut?', picture: cage.svg, timeout_s: 3600}"
)
#: Counts the tones that are begun.
_TONES = """
  window.tones = 0;
  const start = OscillatorNode.prototype.start;
  OscillatorNode.prototype.start = function (...when) { window.tones += 1; return start.apply(this, when); };
"""
_LEAST_PX = 48


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with a plan that asks, and shows a picture with it."""
    folder = tmp_path_factory.mktemp("panel")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.ask("PUT", "/api/v1/pictures/cage.svg", _SVG)
        service.give("asking", _ASKING)
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        yield service


def test_a_question_stands_on_the_panel_with_its_picture_and_the_time_left(
    page: playwright.Page, there: Served
) -> None:
    run = there.queue("asking")
    page.set_viewport_size({"width": 820, "height": 1100})
    to(page, there, "benches/sim/panel")
    expect(heading(page, "Question")).to_be_visible()
    question = region(page, "Question")
    expect(question).to_contain_text(re.compile(r"59 min \d+ s left to answer; then the run ends"))
    picture = question.get_by_role("img", name="Picture of the question: cage.svg")
    assert picture.evaluate("one => one.decode().then(() => one.naturalWidth)") > 0
    expect(page.get_by_text("The run goes on when the question is answered.")).to_be_visible()
    small = page.locator("main button, main input, header .stop").evaluate_all(
        "(all, px) => all.filter((one) => one.offsetHeight < px).map((one) => one.outerHTML)",
        _LEAST_PX,
    )
    assert small == []
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Continue", exact=True).click()
    assert there.over(run)["verdict"] == "pass"
    expect(heading(page, "Free")).to_be_visible()


def test_who_does_not_continue_ends_the_run(page: playwright.Page, there: Served) -> None:
    """A 'no' that was typed was recorded as a confirmation, and the run went on."""
    run = there.queue("asking")
    to(page, there, "benches/sim")
    expect(heading(page, "Question: A plan that asks")).to_be_visible()
    page.get_by_label("Remark").fill("no")
    page.get_by_role("button", name="Do not continue: end the run").click()
    over = there.over(run)
    assert over["reason"] == "stopped by the operator, who did not continue at 'Is the cage shut?'"
    assert over["safe_state"] == "confirmed"
    to(page, there, f"runs/{run}")
    expect(heading(page, "A plan that asks ended early")).to_be_visible()
    to(page, there, "benches")
    expect(page.get_by_text("No run has failed since")).to_be_visible()


def test_tones_call_who_has_turned_them_on_and_no_one_else(page: playwright.Page, there: Served) -> None:
    page.add_init_script(_TONES)
    to(page, there, "benches/sim/panel")
    expect(heading(page, "Free")).to_be_visible()
    run = there.queue("asking")
    expect(heading(page, "Question")).to_be_visible()
    assert page.evaluate("tones") == 0
    page.get_by_role("button", name="Sound is off").click()
    page.reload()
    expect(page.get_by_role("button", name="Sound is on")).to_be_visible()
    expect(heading(page, "Question")).to_be_visible()
    assert page.evaluate("tones") == 0
    page.get_by_role("button", name="Emergency stop sim").click()
    expect(heading(page, "Emergency stop")).to_be_visible()
    page.wait_for_function("tones >= 4")
    there.over(run)
    expect(page.get_by_text("When it is safe, an engineer resets the emergency stop.")).to_be_visible()
    there.post("/benches/sim/reset")
    expect(heading(page, "Free")).to_be_visible()


def test_the_wall_follows_a_bench_and_takes_no_input(page: playwright.Page, there: Served) -> None:
    there.over(there.queue())
    to(page, there, "wall")
    card = page.locator(".wall li.bench")
    expect(card).to_contain_text("Free")
    expect(card.get_by_role("list", name="Last verdicts")).to_contain_text("short")
    run = there.queue("asking")
    expect(card).to_contain_text("Question")
    expect(card).to_contain_text("A plan that asks")
    expect(card).to_contain_text("by local")
    assert page.locator("button, input, select").count() == 0
    assert page.locator("html").get_attribute("data-theme") == "dark"
    size_of = "one => parseFloat(getComputedStyle(one).fontSize)"
    word, *others = (
        card.locator(part).first.evaluate(size_of) for part in (".state", "h2", ".plan", "progress + p")
    )
    assert word > 150  # of 900 px in height
    assert word >= 3 * max(others)
    refuse_hard_to_use(page)
    there.post(f"/runs/{run}/answer", {"text": ""})
    there.over(run)
    expect(card).to_contain_text("Free")
    to(page, there, "wall/nothing")
    expect(page.get_by_text("The service has no bench of this name.")).to_be_visible()


def test_the_wall_says_when_its_data_are_old_and_goes_on_by_itself(
    browser: playwright.Browser, tmp_path: Path
) -> None:
    page = browser.new_page()
    page.set_default_timeout(60_000)
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        to(page, service, "wall/sim")
        expect(page.locator(".wall li.bench")).to_contain_text("Free")
        port = service.url.rpartition(":")[2]
    expect(page.get_by_role("alert")).to_contain_text("NOT CURRENT: no answer of the service for")
    expect(page.locator(".wall li.bench")).to_contain_text("Free")
    with served(tmp_path / "data", "--port", port, state=tmp_path / "state"):
        expect(page.get_by_role("alert")).to_have_count(0)
        expect(page.locator(".wall li.bench")).to_contain_text("Free")
