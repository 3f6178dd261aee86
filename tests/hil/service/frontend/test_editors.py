"""Models, controllers, bench files written on the page: mistakes, completion, values, figures, versions."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
_AT_END = "one => { one.focus(); one.setSelectionRange(one.value.length, one.value.length); one.click(); }"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("editors")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT)
        yield service


def test_a_model_is_written_with_what_follows_from_it_and_gets_versions(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "models")
    page.get_by_role("link", name="Write a model").click()
    expect(heading(page, "Write a model")).to_be_visible()
    text, found = page.get_by_label("Text of the model"), region(page, "What follows from it")
    expect(found).to_contain_text("resonance11.4 Hz", timeout=120_000)
    expect(found).to_contain_text("dead time8.00 ms")
    values = region(page, "Values")
    values.get_by_label(re.compile("shaft stiffness")).fill("3000")
    values.get_by_label(re.compile("shaft stiffness")).blur()
    expect(text).to_have_value(re.compile("shaft_stiffness = 3000 "))
    expect(found).not_to_contain_text("11.4 Hz")
    text.evaluate(_AT_END)
    page.keyboard.type("\n[[effects]]\n")
    page.keyboard.press("Control+ ")
    page.keyboard.press("Enter")
    expect(text).to_have_value(re.compile(r"\[\[effects\]\]\nid = $"))
    page.keyboard.press("Control+ ")
    offers = page.get_by_role("list", name="May stand at the cursor")
    offers.get_by_role("button", name="backlash").click()
    expect(page.get_by_role("list", name="Mistakes")).to_contain_text("half_gap_rad")
    text.evaluate(_AT_END)
    page.keyboard.type("\nhalf_gap_rad = -1\n")
    expect(page.locator(".numbers .wrong")).to_have_count(1)
    refuse_hard_to_use(page)
    text.fill(text.input_value().replace("-1", "0.01"))
    page.get_by_label("Name", exact=True).fill("soft_axle")
    page.get_by_role("button", name="Keep as soft_axle").click()
    expect(heading(page, "soft_axle")).to_be_visible()
    page.get_by_role("link", name="Write a new version").click()
    expect(page.get_by_label("Name", exact=True)).to_have_value("soft_axle_2")
    written = page.get_by_label("Text of the model")
    written.fill(written.input_value().replace("3000", "3500"))
    page.get_by_role("button", name="Keep as soft_axle_2").click()
    expect(heading(page, "soft_axle_2")).to_be_visible()
    versions = region(page, "Versions")
    expect(versions.locator("tbody tr")).to_have_count(2)
    versions.get_by_role("button", name="Differences of version 1").click()
    difference = page.get_by_role("region", name="Differences, from that version to today's text")
    expect(difference.locator(".gone")).to_contain_text("shaft_stiffness = 3000")
    expect(difference.locator(".new")).to_contain_text("shaft_stiffness = 3500")
    refuse_hard_to_use(page)
    versions.get_by_role("link", name="Write on from version 1").click()
    expect(page.get_by_label("Text of the model")).to_have_value(re.compile("shaft_stiffness = 3000"))
    expect(page.get_by_label("Name", exact=True)).to_have_value("soft_axle_3")


def test_a_controller_has_its_margins_on_a_chosen_model(page: playwright.Page, there: Served) -> None:
    to(page, there, "controllers/phase_stabilization?write=on")
    found = region(page, "What follows from it")
    choice(page, "Model for its margins").select_option("three_inertia")
    expect(found).to_contain_text("gain margin10.9 dB", timeout=120_000)
    expect(found).to_contain_text("loopstable")
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Keep as phase_stabilization_2").click()
    expect(heading(page, "phase_stabilization_2")).to_be_visible()


def test_a_bench_file_is_checked_at_its_lines(page: playwright.Page, there: Served) -> None:
    to(page, there, "bench-files?write=new")
    found, text = region(page, "What follows from it"), page.get_by_label("Text of the bench file")
    expect(found).to_contain_text("kindsimulated", timeout=120_000)
    text.fill(text.input_value().replace('"rmcu.dbc"', '"/etc/passwd"'))
    expect(page.get_by_role("list", name="Mistakes")).to_contain_text("is not a name alone")
    expect(page.locator(".numbers .wrong")).to_have_text("16")
    refuse_hard_to_use(page)
    text.fill(text.input_value().replace('"/etc/passwd"', '"rmcu.dbc"'))
    page.get_by_role("button", name="Keep as my_bench").click()
    page.get_by_role("link", name="Write a new version").click()
    expect(page.get_by_text("my_bench is there already, and stays what it is")).to_be_visible()
    page.go_back()
    page.get_by_role("button", name="Put the bench into service").click()
    page.get_by_role("link", name="Bench my_bench").click()
    expect(heading(page, "Free")).to_be_visible()
    there.over(there.queue(bench="my_bench"))
    to(page, there, "bench-files/my_bench")
    page.get_by_role("button", name="Take the bench out of service").click()
    expect(page.get_by_role("button", name="Put the bench into service")).to_be_visible()
    refuse_hard_to_use(page)


def test_a_plan_of_before_is_compared_and_comes_back(page: playwright.Page, there: Served) -> None:
    there.give("short", SHORT.replace("upper: 400", "upper: 380"))
    to(page, there, "plans/short")
    versions = region(page, "Versions")
    expect(versions.locator("tbody tr")).to_have_count(2)
    versions.get_by_role("button", name="Differences of version 1").click()
    expect(page.locator(".diff .gone")).to_contain_text("upper: 400")
    refuse_hard_to_use(page)
    versions.get_by_role("link", name="Write on from version 1").click()
    expect(page.get_by_label("Text of the plan")).to_have_value(re.compile("upper: 400"))
    expect(page.get_by_text("No mistake was found.")).to_be_visible()
    page.get_by_role("button", name="Keep as short").click()
    expect(region(page, "Versions").locator("tbody tr")).to_have_count(3)
    assert "upper: 400" in there.get("/plans/short/text").decode()


def test_steps_of_a_plan_are_completed(page: playwright.Page, there: Served) -> None:
    to(page, there, "plans?write=new")
    text = page.get_by_label("Text of the plan")
    text.fill("name: mine\nsteps:\n  - ")
    text.evaluate(_AT_END)
    page.keyboard.type("hold")
    offers = page.get_by_role("list", name="May stand at the cursor")
    offers.get_by_role("button", name="hold_speed").click()
    expect(text).to_have_value("name: mine\nsteps:\n  - hold_speed: ")
    page.keyboard.type("{")
    expect(offers).to_contain_text("km/h")


def test_a_plan_is_started_with_another_controller_and_the_same_values(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "plans/short?bench=sim&value.torque_nm=150")
    part = region(page, "With another controller")
    expect(part.get_by_label("in the plan")).to_have_value("short")
    part.get_by_role("combobox", name="Controller", exact=True).select_option("gain_stabilization")
    part.get_by_label("as plan").fill("short_with_gain")
    refuse_hard_to_use(page)
    part.get_by_role("button", name="Make the plan").click()
    expect(heading(page, re.compile("short_with_gain"))).to_be_visible()
    expect(page.locator("input[name=torque_nm]")).to_have_value("150")
    expect(region(page, "Versions").locator("tbody th").first).to_have_text("short_with_gain")
    assert "gain_stabilization.toml" in there.get("/plans/short_with_gain/text").decode()
