"""Addresses with names that nothing has: they say so, lead to the list, and offer nothing else."""

from __future__ import annotations

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import Served

pytestmark = IN_A_BROWSER


@pytest.fixture
def there(service: Served) -> Served:
    return service


@pytest.fixture
def refusals() -> tuple[str, ...]:
    return ("401 (Unauthorized)", "404 (Not Found)", "422 (Unprocessable")


@pytest.mark.parametrize(
    ("address", "kind", "listed"),
    [
        ("plans/nope", "plan", "plans"),
        ("plans/nope?write=on", "plan", "plans"),
        ("plans/%C3%BCber", "plan", "plans"),
        ("models/nope", "model", "models"),
        ("models/nope?write=on", "model", "models"),
        ("controllers/nope", "controller", "controllers"),
        ("bench-files/nope", "bench file", "bench files"),
        ("benches/nope", "bench", "benches"),
        ("benches/nope/panel", "bench", "benches"),
    ],
)
def test_a_name_that_nothing_has_offers_the_list_alone(
    page: playwright.Page, there: Served, address: str, kind: str, listed: str
) -> None:
    to(page, there, address)
    name = "über" if "%C3" in address else "nope"
    expect(heading(page, f"There is no {kind} '{name}'")).to_be_visible()
    main = page.locator("main")
    links = main.get_by_role("link")
    expect(links).to_have_text([f"All {listed}"])
    expect(main.get_by_role("button")).to_have_count(0)
    expect(main.get_by_role("alert")).to_have_count(0)
    if address == "plans/nope":
        refuse_hard_to_use(page)
    links.click()
    expect(heading(page, listed.capitalize())).to_be_visible()


@pytest.mark.parametrize(
    ("listed", "kind"),
    [
        ("runs", "run"),
        ("recordings", "recording"),
        ("identifications", "identification"),
        ("diagnoses", "diagnosis"),
        ("tunings", "tuning"),
        ("campaigns", "campaign"),
    ],
)
def test_a_number_that_nothing_has_leads_to_the_list(
    page: playwright.Page, there: Served, listed: str, kind: str
) -> None:
    for number in (9999, 9999999999):  # more than the service counts to
        to(page, there, f"{listed}/{number}")
        expect(heading(page, f"There is no {kind} {number}")).to_be_visible()
        main = page.locator("main")
        expect(main.get_by_role("link")).to_have_text([f"All {listed}"])
        expect(main.get_by_role("link")).to_have_attribute("href", f"/{listed}")
        expect(main.get_by_role("alert")).to_have_count(0)


def test_a_design_on_a_model_that_is_not_there_says_so(page: playwright.Page, there: Served) -> None:
    to(page, there, "design?model=nix")
    main = page.locator("main")
    expect(main.get_by_role("alert")).to_contain_text("There is no model 'nix'")
    expect(main.get_by_role("link", name="all models")).to_have_attribute("href", "/models")
    expect(main.get_by_text("Reading the model")).to_have_count(0)
    main.get_by_role("combobox", name="Model", exact=True).select_option("three_inertia")
    expect(region(page, "Margins and peaks")).to_contain_text("gain margin")


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("verdict=nonsense", "There is no verdict 'nonsense'"),
        ("state=asleep", "There is no state 'asleep'"),
        (f"plan={'p' * 500}", "All runs"),
    ],
)
def test_runs_by_what_no_run_can_have_lead_to_all_runs(
    page: playwright.Page, there: Served, query: str, said: str
) -> None:
    to(page, there, f"runs?{query}")
    main = page.locator("main")
    expect(main).to_contain_text(said)
    main.get_by_role("link", name="all runs").click()
    expect(page).to_have_url(f"{there.url}/runs")


def test_a_model_that_was_removed_is_still_written_on_from_its_versions(
    page: playwright.Page, there: Served
) -> None:
    text = there.get("/models/three_inertia/text").decode()
    there.ask("PUT", "/api/v1/models/gone", text)
    there.ask("DELETE", "/api/v1/models/gone")
    to(page, there, "models/gone")
    expect(heading(page, "There is no model 'gone'")).to_be_visible()
    region(page, "Versions").get_by_role("link", name="Write on from version 1").click()
    expect(page.get_by_label("Text of the model")).to_have_value(text)
