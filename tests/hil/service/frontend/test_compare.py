"""Runs of a plan and of its changed copy side by side, and the best of them one click away."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, heading, region, to
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
_COPY = SHORT.replace("name: short", "name: copied").replace("to_nm: $torque_nm", "to_nm: 120")


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Run 1 of a plan at 100 N m, run 2 of its copy at 120 N m."""
    folder = tmp_path_factory.mktemp("compare")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT)
        service.give("copied", _COPY)
        yield service


def test_the_list_of_runs_to_compare_with_says_why_it_is_empty(page: playwright.Page, there: Served) -> None:
    to(page, there, "compare")
    expect(page.get_by_text("No run has ended yet.")).to_be_visible()
    there.over(there.queue())
    to(page, there, "compare?runs=1")
    expect(page.get_by_text("No other run has ended yet")).to_be_visible()


def test_a_run_is_not_compared_with_itself(page: playwright.Page, there: Served) -> None:
    to(page, there, "compare?runs=1,1")
    expect(page.get_by_text("A run is not compared with itself: choose another one.")).to_be_visible()
    expect(page.get_by_role("link", name="run 1", exact=True)).to_have_count(1)
    expect(page.locator("figure.plot")).to_have_count(0)
    expect(page.get_by_text("Choose two runs or more")).to_be_visible()


@pytest.mark.parametrize("refusals", [("404 (Not Found)",)])
def test_a_run_that_is_not_there_can_be_left_out(page: playwright.Page, there: Served) -> None:
    to(page, there, "compare?runs=1,9999")
    expect(page.get_by_text("There is no run 9999")).to_be_visible()
    page.get_by_role("button", name="Leave out run 9999").last.click()
    expect(page).to_have_url(re.compile("runs=1$"))
    expect(page.get_by_text("There is no run 9999")).to_have_count(0)


@pytest.mark.parametrize("refusals", [("404 (Not Found)",)])
def test_trends_of_a_bench_that_is_not_there_lead_to_those_that_are(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "trends?bench=none&plan=short")
    expect(page.get_by_text("There is no bench 'none'")).to_be_visible()
    expect(page.get_by_role("link", name="All benches")).to_be_visible()


def test_a_run_of_a_copy_is_compared_with_the_best_run_in_one_click(
    page: playwright.Page, there: Served
) -> None:
    there.over(there.queue("copied"))
    to(page, there, "runs/1")
    expect(
        page.get_by_text(
            re.compile("The best of the 2 runs most like it that passed these criteria: margin \\d")
        )
    ).to_be_visible()
    to(page, there, "compare?runs=1")
    group = choice(page, "and").locator("optgroup")
    expect(group.nth(0)).to_have_attribute("label", "runs of short")
    expect(group.nth(1)).to_contain_text("2: copied")
    to(page, there, "runs/2")
    page.get_by_role("link", name="Compare with the best run (1: other plan: short; margin").click()
    expect(heading(page, "Compare runs")).to_be_visible()
    expect(page).to_have_url(re.compile("runs=2,1"))
    differs = page.locator(".differs")
    expect(differs).to_contain_text("segment s (step): to_nm 100 ($torque_nm)")
    expect(differs).to_contain_text(re.compile("instead of 120.N.m"))
    assert page.locator("main").inner_text().count("to_nm") == 1
    expect(region(page, "Criteria").locator("table")).to_contain_text("Peak of the shaft torque")
    expect(page.locator("figure.plot")).to_have_count(3)
    refuse_hard_to_use(page)


def test_the_limit_that_a_run_fails_is_drawn_beside_the_best_run(
    page: playwright.Page, there: Served
) -> None:
    there.give("limited", SHORT.replace("name: short", "name: limited").replace("upper: 400", "upper: 130"))
    best = there.queue("limited", values={"torque_nm": 50})
    failed = there.queue("limited", values={"torque_nm": 150})
    assert [there.over(run)["verdict"] for run in (best, failed)] == ["pass", "fail"]
    to(page, there, f"runs/{failed}")
    differs = f"({best}: other values: torque_nm = 50; margin"
    page.get_by_role("link", name=f"Compare with the best run {differs}").click()
    plots = page.locator("figure.plot")
    torque, speed = plots.filter(has_text="shaft torque"), plots.filter(has_text="motor speed")
    expect(torque).to_contain_text("limit 130")
    expect_drawn(torque, "gain", "phase", "limit")
    expect(speed).not_to_contain_text("limit")


def test_a_failed_run_is_compared_with_one_of_the_same_plan_bench_and_values(
    page: playwright.Page, there: Served
) -> None:
    plan = SHORT.replace("name: short", "name: twice").replace("upper: 400", "upper: 130")
    there.give("twice", plan)
    there.over(there.queue("twice", values={"torque_nm": 50}))
    same = there.queue("twice", values={"torque_nm": 90})
    assert there.over(same)["verdict"] == "pass"
    there.give("twice", plan.replace("to_nm: $torque_nm", "to_nm: 150"))
    failed = there.queue("twice", values={"torque_nm": 90})
    assert there.over(failed)["verdict"] == "fail"
    to(page, there, f"runs/{failed}")
    expect(page.get_by_role("link", name=f"Compare with the best run ({same}, margin")).to_be_visible()


@pytest.mark.parametrize("refusals", [("404 (Not Found)",)])
def test_more_runs_than_are_compared_are_not_left_out_without_a_word(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, f"compare?runs={','.join(map(str, range(91, 98)))}")
    expect(page.get_by_text("7 runs are chosen; the first 6 are compared.")).to_be_visible()
