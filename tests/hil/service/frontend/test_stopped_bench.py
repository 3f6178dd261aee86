"""A bench that is stopped: reset in the list of benches too, and only by who has looked at the axle."""

from __future__ import annotations

import datetime
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, expect, heading, region, reset_stop, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import ASKING, SHORT, Served, served

pytestmark = IN_A_BROWSER
_RESET = "It is safe: reset the emergency stop"


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        service.give("short", SHORT)
        yield service


def test_a_stop_is_reset_in_the_list_of_benches(page: playwright.Page, there: Served) -> None:
    there.over(there.queue())
    there.post("/benches/sim/emergency-stop")
    to(page, there, "benches")
    card = page.get_by_role("listitem").filter(has_text="sim")
    expect(card).to_contain_text("the motor stood")
    refuse_hard_to_use(page)
    reset_stop(page, there, card)
    expect(card).to_contain_text("Free")
    assert there.get("/benches/sim")["state"] == "free"


def test_where_no_speed_is_known_a_reset_asks_whether_the_axle_stands(
    page: playwright.Page, there: Served
) -> None:
    there.post("/benches/sim/emergency-stop")  # nothing was measured since the service was started
    to(page, there, "benches/sim")
    state = region(page, "State of sim")
    expect(state).to_contain_text("The speed of the motor is not known: the bench is simulated, and exists")
    state.get_by_role("button", name=_RESET).click()
    expect(page.get_by_role("alertdialog")).to_contain_text("Does the axle of sim stand still now?")
    refuse_hard_to_use(page)
    answer(page, "Cancel")
    assert there.get("/benches/sim")["state"] == "emergency_stop"
    state.get_by_role("button", name=_RESET).click()
    answer(page, "It stands still: reset")
    expect(heading(page, "Bench sim Free")).to_be_visible()


def _seen(bench: dict[str, Any], speed_rad_s: float, ago_s: float) -> dict[str, Any]:
    """A bench whose motor was last seen to turn so long ago."""
    at = (datetime.datetime.now(datetime.UTC) - datetime.timedelta(seconds=ago_s)).isoformat()
    return {**bench, "last_speed": {"speed_rad_s": speed_rad_s, "at": at, "turns": True}}


def _ask(page: playwright.Page, there: Served, listed: dict[str, Any], look: Callable[[], Any]) -> Any:
    """Ask to reset in the list of benches, which shows one look at the speed; later ones come by `look`."""
    page.route("**/api/v1/benches", lambda route: route.fulfill(json=[listed]))
    page.route("**/api/v1/benches/sim", lambda route: route.fulfill(json=look()))
    to(page, there, "benches")
    page.get_by_role("button", name=_RESET).click()
    return page.get_by_role("alertdialog")


def test_a_bench_that_was_just_seen_to_turn_cannot_be_reset(page: playwright.Page, there: Served) -> None:
    there.post("/benches/sim/emergency-stop")
    shown = [_seen(there.get("/benches/sim"), 42.1, 0)]
    page.route("**/api/v1/benches", lambda route: route.fulfill(json=shown))
    to(page, there, "benches")
    card = page.get_by_role("listitem").filter(has_text="sim")
    expect(card).to_contain_text("the motor turned at 42.1")
    expect(card).to_contain_text("Wait until it stands, or brake it: a reset is refused while it turns.")
    expect(card.get_by_role("button", name=_RESET)).to_be_disabled()
    refuse_hard_to_use(page)
    shown[0] = _seen(shown[0], 42.1, 60)  # nothing is seen any more: a person has to look
    expect(card.get_by_role("button", name=_RESET)).to_be_enabled()
    card.get_by_role("button", name=_RESET).click()
    expect(page.get_by_role("alertdialog")).to_contain_text("Does the axle of sim stand still now?")


@pytest.mark.parametrize("refusals", [("401 (Unauthorized)", "409 (Conflict)")])
def test_a_look_from_before_the_stop_is_followed_by_one_from_after_it(
    page: playwright.Page, there: Served
) -> None:
    """What was confirmed meanwhile does not count where the axle is then seen to turn."""
    there.post("/benches/sim/emergency-stop")
    old = _seen(there.get("/benches/sim"), 137.0, 200)
    shown, refusal = [old], {"what": "the axle turns: at the last look the motor had 42.0 rad/s", "fix": ""}
    asked = _ask(page, there, old, lambda: shown[0])
    page.route("**/api/v1/benches/sim/reset", lambda route: route.fulfill(status=409, json=refusal))
    expect(asked).to_contain_text("the motor turned at 137")
    asked.get_by_role("button", name="It stands still: reset").click()
    expect(page.get_by_role("button", name="Looking at the speed …")).to_be_disabled()
    shown[0] = _seen(old, 42.0, 0)
    expect(page.get_by_role("alert")).to_contain_text("the axle turns: at the last look the motor had 42.0")
    expect(asked).to_have_count(0)


def test_a_question_about_a_stop_that_was_reset_elsewhere_closes(
    page: playwright.Page, there: Served
) -> None:
    there.post("/benches/sim/emergency-stop")
    to(page, there, "benches/sim")
    region(page, "State of sim").get_by_role("button", name=_RESET).click()
    expect(page.get_by_role("alertdialog")).to_be_visible()
    there.post("/benches/sim/reset")
    expect(page.get_by_role("alertdialog")).to_be_hidden()


def test_a_stop_says_at_once_when_it_can_be_reset(page: playwright.Page, there: Served) -> None:
    there.give("asking", ASKING)
    run = there.queue("asking")
    there.until(run, lambda found: found["prompt"])
    to(page, there, "benches/sim")
    page.get_by_role("button", name="Emergency stop sim").click()
    state = region(page, "State of sim")
    expect(state).to_contain_text("Stopping: the bench goes to its safe state")
    expect(state).to_contain_text("When the run has ended, an engineer can reset the emergency stop.")
    there.over(run)
    expect(state).to_contain_text("When it is safe, an engineer resets the emergency stop.")
    expect(state.get_by_role("button", name=_RESET)).to_be_visible()


def test_a_run_that_was_stopped_before_it_began_says_so_in_the_list(
    page: playwright.Page, there: Served
) -> None:
    run = there.queue()
    there.until(run, lambda found: found["state"] == "running")
    there.post("/benches/sim/emergency-stop")
    there.over(run)
    to(page, there, "benches/sim")
    expect(region(page, "Latest runs")).to_contain_text("stopped before it began: emergency stop")
    to(page, there, "runs")
    expect(page.locator("tbody")).to_contain_text("stopped before it began: emergency stop")


def test_a_stop_from_a_view_without_a_bench_is_shown_there_until_it_is_reset(
    page: playwright.Page, there: Served
) -> None:
    there.over(there.queue())
    to(page, there, "settings")
    notice = region(page, "Emergency stop of sim")
    expect(heading(page, "Settings")).to_be_visible()
    expect(notice).to_have_count(0)
    page.get_by_role("button", name="Emergency stop all benches").click()
    expect(notice).to_contain_text("sim is stopped: its emergency stop stays until it is reset there.")
    page.get_by_role("link", name="Runs", exact=True).click()
    expect(notice).to_be_visible()
    to(page, there, "runs/1")
    expect(heading(page, "short")).to_be_visible()
    notice.get_by_role("link", name="sim", exact=True).click()
    expect(heading(page, "Bench sim Emergency stop")).to_be_visible()
    expect(notice).to_have_count(0)  # the bench's own state says it
    page.get_by_role("link", name="Runs", exact=True).click()
    expect(notice).to_be_visible()
    refuse_hard_to_use(page)
    there.post("/benches/sim/reset")
    expect(notice).to_have_count(0)


def test_a_stop_that_a_bench_has_not_confirmed_is_shown_as_such(page: playwright.Page, there: Served) -> None:
    bench = {**there.get("/benches/sim"), "state": "away", "stop_confirmed": False}
    page.route("**/api/v1/benches", lambda route: route.fulfill(json=[bench]))
    to(page, there, "runs")
    expect(region(page, "Emergency stop of sim")).to_contain_text("the bench has NOT CONFIRMED it")
    page.goto("about:blank")
