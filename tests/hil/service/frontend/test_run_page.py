"""The head of a run's page: why it waits, and why it did not pass, before anything else."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, region, reset_stop, to
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import ASKING, SHORT, Served, served

pytestmark = IN_A_BROWSER
_UNSETTLED = SHORT.replace("name: short", "name: unsettled").replace("after_s: 1", "after_s: 2.1") + (
    "  - {segment: s, metric: settling_shaft_torque, unit: s}\n"
)
_FAILING = SHORT.replace("name: short", "name: failing").replace("upper: 400", "upper: 90")


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        service.give("short", SHORT)
        service.give("asking", ASKING)
        service.give("failing", _FAILING)
        service.give("unsettled", _UNSETTLED)
        yield service


def test_a_run_that_waits_says_why_and_has_the_action_that_ends_it(
    page: playwright.Page, there: Served
) -> None:
    asking = there.queue("asking")
    there.until(asking, lambda run: run["prompt"] is not None)
    waiting = there.queue()
    to(page, there, f"runs/{waiting}")
    why = region(page, "Why it waits")
    expect(why).to_contain_text(f"Run {asking} (asking, by local) is on the bench and waits for an answer.")
    expect(why.get_by_role("link", name=f"Run {asking}")).to_be_visible()
    page.get_by_role("button", name="Emergency stop sim").click()
    expect(why).to_contain_text("It waits because the emergency stop of sim is latched.")
    there.over(asking)
    refuse_hard_to_use(page)
    reset_stop(page, there, why, f"reset the emergency stop. Run {waiting} starts then.")
    there.over(waiting)
    expect(page.locator("h1")).to_contain_text("pass")
    expect(why).to_have_count(0)


def test_a_note_that_is_being_typed_keeps_focus_and_caret_as_its_run_begins_and_ends(
    page: playwright.Page, there: Served
) -> None:
    there.post("/benches/sim/emergency-stop")
    run = there.queue("asking")
    to(page, there, f"runs/{run}")
    note = page.get_by_label("Note", exact=True)
    note.fill("the shaft was warm")
    note.evaluate("one => one.setSelectionRange(4, 9)")
    there.post("/benches/sim/reset")
    there.until(run, lambda found: found["prompt"] is not None)
    expect(page.locator("h1")).to_contain_text("running")
    page.keyboard.type("axle")
    there.post(f"/runs/{run}/answer", {"text": "yes"})
    there.over(run)
    expect(page.locator("h1")).to_contain_text("pass")
    expect(page.locator("figure.plot").first).to_be_visible()
    page.keyboard.type(" of run 1")
    expect(note).to_have_value("the axle of run 1 was warm")
    expect(note).to_be_focused()
    note.fill("")


def test_the_page_of_a_queued_run_says_that_the_service_is_gone(
    browser: playwright.Browser, there: Served
) -> None:
    there.post("/benches/sim/emergency-stop")
    waiting = there.queue()
    with browser.new_context(locale="en-US") as context:
        page = context.new_page()
        to(page, there, f"runs/{waiting}")
        expect(region(page, "Why it waits")).to_be_visible()
        there.process.kill()
        expect(page.get_by_role("alert").filter(has_text="The service does not answer")).to_be_visible()


def test_a_failed_run_begins_with_the_criterion_that_failed_and_leads_to_its_place(
    page: playwright.Page, there: Served
) -> None:
    failed = there.queue("failing")
    assert there.over(failed)["verdict"] == "fail"
    to(page, there, f"runs/{failed}")
    outcome = region(page, "Why it did not pass")
    expect(outcome).to_contain_text(
        re.compile(r"Peak of the shaft torque in s: \d+.N.m, allowed is ≤.90\.0.N.m\.")
    )
    first = page.locator("main h1, main section").nth(1)
    expect(first).to_have_attribute("aria-label", "Why it did not pass")
    outcome.get_by_role("button", name="Show its segment in the plots").click()
    expect(page).to_have_url(re.compile(r"\?t=\d"))
    criteria = region(page, "Criteria").first
    expect(criteria).to_contain_text("Peak of the shaft torque")
    expect(criteria).to_contain_text("s.peak_shaft_torque")
    criteria.get_by_text("What is measured").click()
    expect(criteria).to_contain_text("the value farthest in the step's direction")
    refuse_hard_to_use(page)


def test_the_limit_that_a_run_failed_is_drawn_with_its_name_in_its_own_plots(
    page: playwright.Page, there: Served
) -> None:
    failed = there.queue("failing")
    there.over(failed)
    to(page, there, f"runs/{failed}")
    plot = page.get_by_role(
        "img", name=re.compile("^Plot 2: shaft torque; Peak of the shaft torque: limit 90")
    )
    expect_drawn(plot, "gain", "fail")


def test_moments_of_a_run_are_to_the_second_and_its_duration_stands_beside_them(
    page: playwright.Page, there: Served
) -> None:
    there.over(there.queue())
    to(page, there, "runs/1")
    facts = page.locator(".facts")
    for name in ("queued at", "began", "ended"):
        expect(facts).to_contain_text(re.compile(rf"{name}\w+ \d+, \d+, \d+:\d\d:\d\d"))
    expect(facts).to_contain_text(re.compile(r"duration\d[\d.]*\ss|duration\d+ min"))
    to(page, there, "runs")
    table = region(page, "Runs, table")
    expect(table.get_by_role("columnheader", name="duration")).to_be_visible()
    expect(table.locator("tbody")).to_contain_text(re.compile(r"\d\ss"))
    refuse_hard_to_use(page)
    to(page, there, "audit")
    expect(page.locator("tbody time").first).to_have_text(re.compile(r":\d\d:\d\d"))


def test_a_run_that_failed_stands_in_the_list_of_benches(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches")
    expect(page.get_by_text("No run has failed since")).to_be_visible()
    failed, passed = there.queue("failing"), there.queue("short")
    there.over(failed)
    there.over(passed)
    failures = page.get_by_role("region", name=re.compile("^Runs that failed since "))
    expect(failures.get_by_role("listitem")).to_have_count(1)
    expect(failures).to_contain_text(f"fail Run {failed}: failing, by local")
    refuse_hard_to_use(page)
    failures.get_by_role("link", name=f"Run {failed}").click()
    expect(region(page, "Why it did not pass")).to_be_visible()


def test_a_passed_run_says_beside_its_verdict_that_a_quantity_did_not_settle(
    page: playwright.Page, there: Served
) -> None:
    run = there.queue("unsettled")
    assert there.over(run)["verdict"] == "pass"
    criteria = {one["id"]: one["verdict"] for one in there.get(f"/runs/{run}/view")["criteria"]}
    assert criteria["s.settling_shaft_torque"] == "did_not_settle"
    to(page, there, f"runs/{run}")
    expect(page.get_by_text("One measured quantity did not settle")).to_contain_text(
        "counts neither for nor against the run: Settling time of the shaft torque in s."
    )
    page.get_by_role("link", name="Show them among the criteria").click()
    expect(region(page, "Criteria").first.get_by_text("did not settle", exact=True)).to_be_in_viewport()
    refuse_hard_to_use(page)


def test_a_run_that_was_stopped_begins_with_what_stopped_it(page: playwright.Page, there: Served) -> None:
    stopped = there.queue("asking")
    there.until(stopped, lambda run: run["prompt"] is not None)
    there.post(f"/runs/{stopped}/abort")
    there.over(stopped)
    to(page, there, f"runs/{stopped}")
    outcome = region(page, "Why it did not pass")
    expect(outcome).to_contain_text("stopped by the operator")
    outcome.get_by_role("button", name="Show it in the plots").click()
    expect(page).to_have_url(re.compile(r"\?t=\d"))
    expect(heading(page, re.compile("asking"))).to_be_visible()


@pytest.mark.parametrize("refusals", [("404 (Not Found)",)])
def test_the_address_of_a_bench_that_there_is_not_is_no_alarm(page: playwright.Page, there: Served) -> None:
    for address in ("benches/none", "benches/none/panel"):
        to(page, there, address)
        expect(heading(page, "There is no bench 'none'")).to_be_visible()
        expect(page.get_by_role("alert")).to_have_count(0)
        expect(page.get_by_role("button", name="Emergency stop all benches")).to_be_visible()


def test_after_a_stop_the_panel_shows_no_old_values_and_no_time_left(
    page: playwright.Page, there: Served
) -> None:
    asking = there.queue("asking")
    there.until(asking, lambda run: run["prompt"] is not None)
    to(page, there, "benches/sim/panel")
    page.get_by_role("button", name="Emergency stop sim").click()
    expect(page.locator("h1")).to_contain_text("Emergency stop")
    expect(page.get_by_role("button", name="End the run", exact=True)).to_have_count(0)
    expect(page.locator(".dials dd:not(.quiet)").first).to_contain_text("–")
    expect(page.get_by_text(re.compile("about .* left"))).to_have_count(0)


def test_the_stop_is_of_the_runs_bench_also_after_its_end(page: playwright.Page, there: Served) -> None:
    asking = there.queue("asking")
    there.until(asking, lambda run: run["prompt"] is not None)
    to(page, there, f"runs/{asking}")
    stop = page.get_by_role("button", name=re.compile("^Emergency stop"))
    expect(stop).to_have_text("Emergency stop sim only")
    seen = page.evaluate_handle(
        """() => { const seen = [], button = document.querySelector("button.stop");
        new MutationObserver(() => seen.push(button.textContent)).observe(button,
            { characterData: true, childList: true, subtree: true }); return seen; }"""
    )
    there.post(f"/runs/{asking}/answer", {"text": ""})
    there.over(asking)
    expect(page.locator("h1")).to_contain_text("pass")
    expect(stop).to_have_text("Emergency stop sim only")
    assert seen.json_value() == []  # not for a moment
    page.get_by_role("link", name="Runs", exact=True).first.click()
    expect(stop).to_have_text("Emergency stop all benches")


def test_a_run_that_was_stopped_has_the_button_that_resets_the_stop(
    page: playwright.Page, there: Served
) -> None:
    asking = there.queue("asking")
    there.until(asking, lambda run: run["prompt"] is not None)
    to(page, there, f"runs/{asking}")
    page.get_by_role("button", name="Emergency stop sim only").click()
    there.over(asking)
    state = region(page, "State of sim")
    expect(state).to_contain_text("emergency stop since")
    refuse_hard_to_use(page)
    reset_stop(page, there, state)
    expect(state).to_have_count(0)
    assert there.get("/benches/sim")["state"] == "free"


def test_the_palette_has_the_stop_under_its_name_only(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches")
    expect(heading(page, "Benches")).to_be_visible()
    page.keyboard.press("Control+k")
    page.keyboard.type("e")
    offered = page.get_by_role("dialog").get_by_role("option")
    expect(offered.first).to_be_visible()
    expect(offered.filter(has_text="Emergency stop")).to_have_count(0)
    page.keyboard.type("mergency")
    chosen = page.get_by_role("dialog").locator("[aria-selected=true]")
    expect(chosen).to_contain_text("Emergency stop all benches")
    page.keyboard.press("Enter")
    expect(page.locator("main")).to_contain_text("Emergency stop")
    assert there.get("/benches/sim")["state"] == "emergency_stop"
