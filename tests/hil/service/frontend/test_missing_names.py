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
