"""Runs that differ in their values or their plan alone are told apart wherever they stand."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import ASKING, SHORT, Served, served

pytestmark = IN_A_BROWSER
_TITLE = "Steps of torque"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Runs 1 and 2 of a plan and of its copy ended, 3 asks, 4 and 5 wait; all have one title."""
    folder = tmp_path_factory.mktemp("names")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        for name, text in (("short", SHORT), ("copied", SHORT), ("asking", ASKING)):
            titled = re.sub(r"name: \w+", f"name: {name}\ntitle: {_TITLE}", text, count=1)
            service.give(name, titled.replace("upper: 400", "upper: 90"))
        for plan in ("short", "copied"):
            service.over(service.queue(plan, values={"torque_nm": 150}))
        service.until(service.queue("asking"), lambda run: run["prompt"] is not None)
        service.queue("short", values={"torque_nm": 120})
        service.queue("short", values={"torque_nm": 175})
        yield service


def test_the_queue_and_the_bench_name_plan_and_values(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    rows = region(page, "Queue").get_by_role("listitem")
    expect(rows.nth(0)).to_contain_text(f"4: {_TITLE} (short, torque_nm = 120)")
    expect(rows.nth(1)).to_contain_text(f"5: {_TITLE} (short, torque_nm = 175)")
    expect(page.locator("h1")).to_contain_text(f"{_TITLE} (asking)")
    latest = region(page, "Latest runs").first
    expect(latest).to_contain_text("copied, torque_nm = 150")
    expect(latest).to_contain_text("short, torque_nm = 150")


def test_lists_of_runs_name_plan_and_values(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches")
    failed = page.locator("ul.queue")
    expect(failed).to_contain_text(f"Run 1: {_TITLE} (short, torque_nm = 150)")
    expect(failed).to_contain_text(f"Run 2: {_TITLE} (copied, torque_nm = 150)")
    expect(page.locator(".bench")).to_contain_text(f"Run 3: {_TITLE} (asking)")
    to(page, there, "runs")
    expect(page.locator("tbody")).to_contain_text("copied, torque_nm = 150")
    to(page, there, "wall")
    expect(page.locator(".wall ol")).to_contain_text("copied, torque_nm = 150")
    expect(page.locator(".wall .plan")).to_have_text(f"{_TITLE} (asking)")
    to(page, there, "compare?runs=1")
    expect(choice(page, "and")).to_contain_text(f"2: {_TITLE} (copied, torque_nm = 150)")
    to(page, there, "diagnoses")
    expect(page.locator("main")).to_contain_text(f"run 1: {_TITLE} (short, torque_nm = 150), sim")
    refuse_hard_to_use(page)


def test_the_audit_log_has_the_values_that_were_asked_for(page: playwright.Page, there: Served) -> None:
    to(page, there, "audit")
    expect(page.locator("tbody")).to_contain_text("short on sim, torque_nm = 175")
    expect(page.locator("tbody")).to_contain_text("short on sim, torque_nm = 120")
