"""A campaign started on the page, watched, cancelled, gone on with, and its files."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.campaign.short import CAMPAIGN
from tests.hil.service.jobs.test_campaigns import LONG
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import Served, served

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium"),
]


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("page-campaigns")
    with served(folder / "data", "--workers", "0", state=folder / "state") as service:
        yield service


def test_a_campaign_is_begun_watched_cancelled_and_gone_on_with(
    page: playwright.Page, there: Served, tmp_path: Path
) -> None:
    (tmp_path / "short.yaml").write_text(PLAN)
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN + "pass_share: 0.5\n")
    page.goto(there.url)
    expect = playwright.expect
    expect.set_options(timeout=60_000)
    expect(page.get_by_role("heading", name="Free")).to_be_visible()
    page.locator("#campaigns > summary").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#campaign-text")).to_have_value(re.compile(r"name: robustness"))
    page.locator("#campaign-example").select_option("own file")
    page.get_by_label("Campaign file").set_input_files(tmp_path / "campaign.yaml")
    expect(page.locator("#campaign-text")).to_have_value(re.compile(r"name: short_campaign"))
    page.get_by_label("Files of plan, model and controllers").set_input_files(tmp_path / "short.yaml")
    page.get_by_role("button", name="Simulate").click()
    expect(page.locator("#campaign-message")).to_contain_text("16 simulations")
    page.locator("#campaign-text").fill(LONG)
    page.get_by_role("button", name="Simulate").click()
    rows = page.locator("#campaign-list tbody tr")
    expect(rows.first).to_contain_text("running")
    page.get_by_role("button", name="Cancel: campaign 2").click()
    expect(rows.first).to_contain_text("cancelled")
    expect(rows.last).to_contain_text("pass")
    expect(rows.last).to_contain_text(
        re.compile(r"phase stabilization: 100.0\s% \(8 of 8; 63.1\s% to 100.0\s%\)")
    )
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Resume: campaign 2").click()
    expect(rows.first).to_contain_text("of 1000, ")
    expect(rows.first).to_contain_text("1000 of 1000")
    page.once("dialog", lambda dialog: dialog.accept())
    page.get_by_role("button", name="Remove: campaign 1").click()
    expect(rows).to_have_count(1)
    with page.expect_download() as fetched:
        rows.first.get_by_role("link", name="table of campaign 2").click()
    assert fetched.value.suggested_filename == "campaign-2-simulations.parquet"
    with page.expect_navigation():
        rows.first.get_by_role("link", name="report of campaign 2").click()
    expect(page.get_by_role("heading", level=1)).to_contain_text("long")
