"""Campaigns on the page: begun by form or files, watched, cancelled, gone on with, and what came of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.campaign.short import CAMPAIGN
from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, choice, expect, heading, region, to
from tests.hil.service.jobs.test_campaigns import LONG
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("page-campaigns")
    with served(folder / "data", "--workers", "0", state=folder / "state") as service:
        yield service


def test_campaigns_of_files_are_begun_watched_cancelled_and_gone_on_with(
    page: playwright.Page, there: Served, tmp_path: Path
) -> None:
    (tmp_path / "short.yaml").write_text(PLAN)
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN + "pass_share: 0.5\n")
    to(page, there, "campaigns")
    text, chosen = page.get_by_label("Content"), choice(page, "Campaign")
    chosen.select_option("robustness")
    expect(text).to_have_value(re.compile(r"name: robustness"))
    chosen.select_option("own file")
    page.get_by_label("Campaign file").set_input_files(tmp_path / "campaign.yaml")
    expect(text).to_have_value(re.compile(r"name: short_campaign"))
    page.get_by_label("Files of plan, model and controllers").set_input_files(tmp_path / "short.yaml")
    page.get_by_role("button", name="Simulate").click()
    expect(heading(page, re.compile("short_campaign"))).to_be_visible()
    expect(region(page, "Simulated")).to_contain_text("of 16")
    to(page, there, "campaigns")
    chosen.select_option("own file")
    page.get_by_label("Files of plan, model and controllers").set_input_files(tmp_path / "short.yaml")
    text.fill(LONG)
    page.get_by_role("button", name="Simulate").click()
    expect(heading(page, re.compile("long running"))).to_be_visible()
    page.get_by_role("button", name="Cancel: campaign 2").click()
    expect(heading(page, re.compile("long cancelled"))).to_be_visible()
    page.get_by_role("link", name="Campaigns").click()
    rows = page.locator(".campaigns tbody tr")
    expect(rows.last).to_contain_text("pass")
    expect(rows.last).to_contain_text(re.compile(r"phase stabilization: 100.0% \(8 of 8; 63.1% to 100.0%\)"))
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Resume: campaign 2").click()
    expect(rows.first).to_contain_text("of 1,000, ")
    expect(rows.first).to_contain_text("1,000 of 1,000")
    page.get_by_role("link", name="2", exact=True).click()
    with page.expect_download() as fetched:
        page.get_by_role("link", name="table (Parquet)").click()
    assert fetched.value.suggested_filename == "campaign-2-simulations.parquet"
    with page.expect_popup() as report:
        page.get_by_role("link", name="report", exact=True).click()
    expect(report.value.get_by_role("heading", level=1)).to_contain_text("long")
    report.value.close()


def test_distributions_what_decides_and_worst_cars_are_shown(page: playwright.Page, there: Served) -> None:
    to(page, there, "campaigns/1")
    criteria = region(page, "Criteria")
    expect(criteria.locator("table")).to_contain_text("phase.peak_shaft_torque")
    criteria.get_by_role("button", name="phase.peak_shaft_torque", exact=True).click()
    histograms = region(page, "Distribution of phase.peak_shaft_torque").locator("figure")
    expect(histograms).to_have_count(2)
    expect_drawn(histograms.first, "gain", "limit")
    expect(region(page, "What decides phase.peak_shaft_torque").locator("table")).to_contain_text(
        "model.vehicle_inertia"
    )
    expect(region(page, "Worst cars").locator("tbody tr")).to_have_count(10)
    refuse_hard_to_use(page)


def test_a_worst_car_is_run_on_a_simulated_bench(page: playwright.Page, there: Served) -> None:
    to(page, there, "campaigns/1")
    row = region(page, "Worst cars").locator("tbody tr").first
    number, margin = row.locator("td").nth(0).inner_text(), row.locator("td").nth(2).inner_text()
    assert margin
    row.get_by_role("button", name=f"Run car {number} on a simulated bench").click()
    expect(heading(page, re.compile(f"campaign-1-car-{number} (pass|fail)"))).to_be_visible()
    expect(page.locator("main")).to_contain_text(f"campaign-1-car-{number}")
    to(page, there, "campaigns/1")
    expect(row.get_by_role("link", name="run 1", exact=True)).to_be_visible()


def test_a_campaign_is_begun_by_the_form_and_removed(page: playwright.Page, there: Served) -> None:
    there.give("short", PLAN)
    to(page, there, "campaigns")
    expect(choice(page, "Plan")).to_contain_text("short.yaml")
    refuse_hard_to_use(page)
    page.get_by_label("Name", exact=True).fill("by_form")
    choice(page, "Plan").select_option("short.yaml")
    page.get_by_role("checkbox", name="gain_stabilization").check()
    page.get_by_label("Draws").fill("2")
    page.get_by_text("What differs from car to car").click()
    page.get_by_label("tyre stiffness").fill("0.2")
    page.get_by_text("Values that are tried").click()
    page.get_by_role("button", name="Vary a value").click()
    row = page.locator("details .row").first
    row.get_by_label("Name").fill("model.vehicle_inertia")
    for label, value in (("from", "250"), ("to", "350"), ("in so many values", "3")):
        row.get_by_label(label, exact=True).fill(value)
    expect(page.get_by_label("Content")).to_have_value(
        re.compile(r"vehicle_inertia: \{from: 250, to: 350, count: 3\}\ntolerance:\n  tyre_stiffness: 0.2")
    )
    page.get_by_role("button", name="Simulate").click()
    expect(heading(page, re.compile("by_form ended"))).to_be_visible()
    expect(region(page, "Share that passes")).to_contain_text("gain stabilization")
    expect(region(page, "Simulated")).to_contain_text("6 of 6")
    page.get_by_role("button", name=re.compile("Remove: campaign")).click()
    answer(page, "Remove")
    expect(heading(page, "Campaigns")).to_be_visible()
    expect(page.get_by_text("by_form")).to_have_count(0)


def test_each_wrong_field_of_the_form_keeps_its_message(page: playwright.Page, there: Served) -> None:
    to(page, there, "campaigns")
    typed = {"Draws": "2.5", "Seed": "-1", "Pass share": "2", "Name": "<b>x</b>"}
    button, messages = page.get_by_role("button", name="Simulate"), page.locator("form .refused")
    expect(page.get_by_label("Draws")).to_be_visible()
    for number, (label, text) in enumerate(typed.items(), 1):
        page.get_by_label(label, exact=True).fill(text)
        page.get_by_label("Title", exact=True).focus()
        expect(messages).to_have_count(number)
        expect(button).to_be_disabled()
    refuse_hard_to_use(page)
    for _ in typed:
        page.locator("form input[aria-invalid=true]").first.fill("1")
    expect(messages).to_have_count(0)
    expect(button).to_be_enabled()
