"""A plan that was removed: its versions stay within reach, and what was being written is given anew."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        service.give("gone", SHORT.replace("name: short", "name: gone"))
        yield service


@pytest.fixture
def refusals() -> tuple[str, ...]:
    return ("404 (Not Found)", "409 (Conflict)")


def test_a_run_leads_to_the_versions_of_its_removed_plan(page: playwright.Page, there: Served) -> None:
    there.over(run := there.queue("gone"))
    there.ask("DELETE", "/api/v1/plans/gone")
    to(page, there, f"runs/{run}")
    page.get_by_role("link", name="gone", exact=True).click()
    expect(heading(page, "There is no plan 'gone'")).to_be_visible()
    refuse_hard_to_use(page)
    region(page, "Versions").get_by_role("link", name="Write on from version 1").click()
    text = page.get_by_label("Text of the plan")
    expect(text).to_have_value(SHORT.replace("name: short", "name: gone"))
    text.fill(text.input_value().replace("upper: 400", "upper: 374"))
    page.get_by_role("button", name="Keep as gone").click()
    expect(heading(page, "gone")).to_be_visible()
    assert "upper: 374" in there.get("/plans/gone/text").decode()


def test_what_was_written_of_a_plan_that_was_removed_meanwhile_is_given_anew(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "plans/gone?write=on")
    text = page.get_by_label("Text of the plan")
    expect(text).to_be_visible()
    text.fill(text.input_value().replace("upper: 400", "upper: 374"))
    there.ask("DELETE", "/api/v1/plans/gone")
    page.get_by_role("button", name="Keep as gone").click()
    region(page, "It was removed meanwhile").get_by_role("button", name="Give gone anew").click()
    expect(heading(page, "gone")).to_be_visible()
    assert "upper: 374" in there.get("/plans/gone/text").decode()
