"""What people write on the page: plans with their mistakes at the line, tags and notes of runs."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, choice, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with two runs that ended."""
    folder = tmp_path_factory.mktemp("writing")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT)
        for _ in range(2):
            service.over(service.queue())
        yield service


def test_mistakes_stand_at_their_lines_and_the_forecast_beside_them(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "plans/short")
    page.get_by_role("link", name="Edit", exact=True).click()
    text, forecast = page.get_by_label("Text of the plan"), region(page, "What it would do")
    expect(text).to_have_value(re.compile("name: short"))
    expect(page.get_by_text("No mistake was found.")).to_be_visible()
    expect(forecast).to_contain_text("Fits the bench", timeout=180_000)
    criteria = forecast.get_by_role("region", name="Criteria, table")
    expect(criteria).to_contain_text(re.compile(r"s\.peak_shaft_torque10\d.N.m"))
    forecast.get_by_role("textbox", name="torque_nm in N m").fill("150")
    expect(criteria).to_contain_text(re.compile(r"s\.peak_shaft_torque15\d.N.m"), timeout=180_000)
    written = text.input_value()
    text.fill(written.replace("hold_speed:", "hold_sped:"))
    mistakes = page.get_by_role("list", name="Mistakes")
    expect(mistakes).to_contain_text("hold_sped")
    expect(page.locator(".numbers .wrong")).to_have_text("7")
    expect(page.get_by_role("button", name="Keep as short")).to_be_disabled()
    mistakes.get_by_role("button", name="line 7").click()
    selected = "one => one.value.slice(one.selectionStart, one.selectionEnd)"
    assert text.evaluate(selected).strip().startswith("- hold_sped")
    refuse_hard_to_use(page)
    text.fill(written.replace("name: short", "name: shorter").replace("default: 100", "default: 190"))
    expect(forecast).to_contain_text("Fits the bench", timeout=180_000)
    page.get_by_role("button", name="Keep as shorter").click()
    expect(heading(page, "shorter")).to_be_visible()
    assert there.get("/plans/shorter")["variables"]["torque_nm"]["default"] == 190


def test_a_plan_is_written_anew_and_a_built_in_one_as_a_copy(page: playwright.Page, there: Served) -> None:
    to(page, there, "plans")
    page.get_by_role("link", name="Write a plan").click()
    expect(heading(page, "Write a plan")).to_be_visible()
    expect(page.get_by_text("No mistake was found.")).to_be_visible()
    to(page, there, "plans/acceptance?write=on")
    expect(page.get_by_role("button", name="Keep as acceptance_copy")).to_be_enabled()


@pytest.mark.parametrize("name", ["n" * 100, "n" * 255, "プラン", "ein plan", "-plan"])
def test_a_name_that_cannot_be_taken_is_said_and_the_rest_is_checked(
    page: playwright.Page, there: Served, name: str
) -> None:
    to(page, there, "plans/short?write=on")
    text = page.get_by_label("Text of the plan")
    expect(text).to_have_value(re.compile("name: short"))
    text.fill(SHORT.replace("name: short", f"name: {name}").replace("hold_speed:", "hold_sped:"))
    expect(page.get_by_text(f"({len(name)} characters) is none.")).to_contain_text("has 1 to 64 letters")
    expect(page.get_by_role("list", name="Mistakes")).to_contain_text("hold_sped")
    expect(page.get_by_role("button", name="Keep the plan")).to_be_disabled()
    text.fill(
        text.input_value().replace("hold_sped:", "hold_speed:").replace(f"name: {name}", f"name: {'n' * 64}")
    )
    expect(page.get_by_role("button", name="Keep as nnnn")).to_be_enabled()


def test_a_run_is_tagged_noted_and_found(page: playwright.Page, there: Served) -> None:
    to(page, there, "runs/1")
    notes = region(page, "Tags and notes")
    notes.get_by_label("Tag").fill("axle-7")
    page.keyboard.press("Enter")
    expect(notes.get_by_role("link", name="axle-7")).to_be_visible()
    notes.get_by_label("Note").fill("<b>noise</b> at 12 s")
    notes.get_by_role("button", name="Add the note").click()
    expect(notes.get_by_role("article")).to_contain_text("<b>noise</b> at 12 s")
    refuse_hard_to_use(page)
    notes.get_by_role("link", name="axle-7").click()
    expect(heading(page, "Runs")).to_be_visible()
    expect(choice(page, "Tag")).to_have_value("axle-7")
    rows = page.locator("tbody tr")
    expect(rows).to_have_count(1)
    expect(rows.first).to_contain_text("axle-7")
    rows.first.get_by_role("link", name="1", exact=True).click()
    notes.get_by_role("button", name="Remove").click()
    answer(page, "Remove")
    expect(notes.get_by_role("article")).to_have_count(0)
    notes.get_by_role("combobox", name="Tag").fill("騒音_2")
    notes.get_by_role("button", name="Add", exact=True).click()
    expect(notes.get_by_role("link", name="騒音_2")).to_be_visible()
    notes.get_by_role("button", name="Take the tag axle-7 off").click()
    expect(notes.get_by_role("link", name="axle-7")).to_have_count(0)
