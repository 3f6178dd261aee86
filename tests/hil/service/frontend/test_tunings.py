"""Controllers are tuned on the page: on a model, and on a simulated bench with a person's consent."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, heading, region, to
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("page-tunings")
    with served(folder / "data", state=folder / "state") as service:
        service.give("short", PLAN)
        yield service


def test_a_controller_is_tuned_on_a_model_and_taken(page: playwright.Page, there: Served) -> None:
    to(page, there, "tunings")
    choice(page, "Plan").select_option("short")
    page.get_by_label("Time limit in minutes").fill("0.2")
    page.get_by_role("button", name="Tune", exact=True).click()
    expect(heading(page, re.compile("Tuning 1 ended"))).to_be_visible(timeout=240_000)
    expect(region(page, "Worst margin")).to_contain_text("tuned")
    expect(region(page, "Numbers of the controller").locator("tbody")).to_contain_text("lead hz")
    expect_drawn(region(page, "What can be traded").locator("figure").first, "gain")
    refuse_hard_to_use(page)
    page.get_by_label("Name", exact=True).fill("tuned")
    page.get_by_role("button", name="Save the controller").click()
    expect(page.get_by_text("Saved as tuned")).to_be_visible()


def test_an_envelope_is_shown_consented_to_and_decisions_follow(page: playwright.Page, there: Served) -> None:
    to(page, there, "tunings")
    choice(page, "Plan").select_option("short")
    page.get_by_label("Rounds").fill("1")
    page.get_by_label("Runs in a round").fill("1")
    expect(page.get_by_role("button", name="Consent and begin")).to_have_count(0)
    page.get_by_role("button", name="Show what it may ask of the bench").click()
    expect(page.get_by_text(re.compile("At most 3 runs on sim"))).to_be_visible()
    expect(page.get_by_text("motor torque", exact=True)).to_be_visible()
    refuse_hard_to_use(page)
    page.get_by_label("Your name: you consent to these runs").fill("A. Name")
    page.get_by_role("button", name="Consent and begin").click()
    expect(heading(page, re.compile(r"Tuning \d+"))).to_be_visible()
    expect(region(page, "Decisions").locator("tbody tr").nth(1)).to_contain_text("identify", timeout=240_000)
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Cancel").click()
    expect(heading(page, re.compile(r"Tuning \d+ (cancelled|ended)"))).to_be_visible(timeout=120_000)
