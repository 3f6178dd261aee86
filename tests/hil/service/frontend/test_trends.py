"""Trends on the page: limits, Cpk with its interval and count, by device under test."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.core.result import CriterionResult, RunResult
from hil.service.store import BenchStore, NewRun, RunStore, open_database
from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, region, to
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import Served, environment_of, served

pytestmark = IN_A_BROWSER
#: Value and device under test: eight of A, whose neighbours differ by 5 N m, and three of B between them.
_RUNS = [(value, "A") for value in (300.0, 305.0) * 4] + [(310.0, "B")] * 3


def _ran(data: Path) -> None:
    """Runs of an earlier day."""
    data.mkdir(parents=True)
    engine = open_database(environment_of(data)["HIL_DATABASE"] or f"sqlite:///{data / 'service.sqlite'}")
    runs, bench = RunStore(engine), BenchStore(engine, "earlier")
    bench.hold("sim")
    of_q = [("q", (torque, "A"), {"torque_nm": torque}) for torque in (50.0, 50.0, 60.0)]
    for number, (plan, (value, dut), values) in enumerate([*of_q, *(("p", one, {}) for one in _RUNS)]):
        text = f"name: {plan} # {values}"
        run, _ = runs.add(NewRun(plan, plan, text, "p.yaml", "sim", values, "anna"), approved=True)
        runs.take(run.id, "earlier")
        one = CriterionResult(id="s.peak", value=value, unit="N m", upper=330.0, verdict="pass")
        creep = CriterionResult(id="s.creep", value=1.0 + 0.1 * number, unit="1", upper=9.0, verdict="pass")
        result = RunResult(
            verdict="pass", plan=plan, bench="sim", real_time_factor=1.0, bench_time_s=1.0,
            safe_state="confirmed", criteria=(one, creep),
        )  # fmt: skip
        runs.end(run.id, "ended", exit_code=0, result=result, dut=dut)
    bench.give_back()
    engine.dispose()


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("page-trends")
    _ran(folder / "data")
    with served(folder / "data", state=folder / "state") as service:
        yield service


def test_cpk_stands_with_its_interval_and_count_for_all_and_for_one_device(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "benches/sim")
    trend = region(page, "Trend over runs of p")
    choice(page, "Criterion").select_option("s.peak")
    expect(trend).to_contain_text("N m, limit ≤ 330 N m, Cpk ")
    expect(trend).to_contain_text(", 11 runs)")
    expect_drawn(trend, "gain")
    choice(page, "of").select_option("A")
    expect(trend).to_contain_text("mean 303 N m, limit ≤ 330 N m, Cpk 2.07 (95 %: 0.66 to 3.48, 8 runs)")
    choice(page, "of").select_option("B")
    figures = "mean 310 N m, limit ≤ 330 N m, Cpk: too few runs (3 of 5)"
    expect(trend).to_contain_text(figures)
    expect(trend.get_by_role("img", name=f"s.peak over 3 runs: {figures}")).to_be_visible()
    refuse_hard_to_use(page)


def test_a_drift_is_told_before_it_reaches_the_limit(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    trend = region(page, "Trend over runs of p")
    expect(trend.get_by_role("status")).to_contain_text("May drift: s.creep (six values in a row rising")
    trend.get_by_role("button", name="s.creep").click()
    expect(choice(page, "Criterion")).to_have_value("s.creep")
    expect(trend).to_contain_text("six values in a row rising or falling (Nelson's rule 3): runs 4 to 14")
    expect_drawn(trend, "phase")  # rings around the values


@pytest.mark.parametrize("refusals", [("404 (Not Found)",)])
def test_trends_open_with_the_plan_and_criterion_that_have_values(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "trends")
    expect(region(page, "Trend over runs of p")).to_contain_text("11 runs")
    expect(choice(page, "Plan")).to_have_value("p")
    expect(choice(page, "Criterion")).to_have_value("s.creep")
    to(page, there, "trends?bench=none")
    expect(page.get_by_text("There is no bench 'none'.")).to_be_visible()


def test_a_trend_says_of_which_values_it_is_and_offers_the_others(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "trends?bench=sim&plan=q&criterion=s.peak")
    trend = region(page, "Trend over runs of q")
    expect(trend).to_contain_text("with the values and the plan's text of run 3: torque_nm = 60.")
    expect(trend).to_contain_text("mean 60.0 N m")
    choice(page, "Values").select_option("torque_nm = 50 (2 runs)")
    expect(trend).to_contain_text("with the values and the plan's text of run 2: torque_nm = 50.")
    expect(trend).to_contain_text("mean 50.0 N m")
    refuse_hard_to_use(page)
    page.reload()
    expect(trend).to_contain_text("mean 50.0 N m")
    to(page, there, "trends?bench=sim&plan=p")
    trend = region(page, "Trend over runs of p")
    expect(trend).to_contain_text("with the values and the plan's text of run 14.")
    expect(choice(page, "Values")).to_have_count(0)  # there are no others


def test_a_trend_has_an_address_of_its_own(page: playwright.Page, there: Served) -> None:
    to(page, there, "trends?bench=sim&plan=p&dut=A&criterion=s.peak")
    trend = region(page, "Trend over runs of p")
    expect(trend).to_contain_text("mean 303 N m, limit ≤ 330 N m, Cpk 2.07")
    expect(choice(page, "of")).to_have_value("A")
    refuse_hard_to_use(page)
    to(page, there, "trends?plan=nothing")
    expect(page.get_by_text("No run of this plan has ended on this bench")).to_be_visible()
