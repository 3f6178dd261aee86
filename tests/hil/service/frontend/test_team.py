"""Reservations, expected times, hand-over notes and who is there, at the page of a bench and the panel."""

from __future__ import annotations

import datetime
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.api_schemas.api import Role
from hil.client import Client, RunWanted
from hil.service.serving import make_token
from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, choice, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, environment_of, served

pytestmark = IN_A_BROWSER


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    data = tmp_path / "data"
    with served(data, state=tmp_path / "state", token=_secret(data, "anna", "engineer")) as service:
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        yield service


def _secret(data: Path, name: str, role: Role) -> str:
    return make_token(data, environment_of(data)["HIL_DATABASE"], name, role).secret


def _enter(page: playwright.Page, there: Served, secret: str, state: str = "Free") -> None:
    to(page, there, "benches/sim")
    page.get_by_label("Token").fill(secret)
    page.get_by_role("button", name="Sign in").click()
    expect(heading(page, re.compile(state))).to_be_visible()


def test_a_bench_is_reserved_handed_over_and_a_run_is_let_in(page: playwright.Page, there: Served) -> None:
    bert = Client(there.url, _secret(there.data, "bert", "operator"))
    _enter(page, there, there.token)
    expect(page.get_by_text("On this page now: anna")).to_be_visible()
    expect(region(page, "Reservations")).to_contain_text("Nobody has reserved the bench.")
    page.get_by_text("Reserve the bench", exact=True).click()
    button = page.get_by_role("button", name="Reserve", exact=True)
    expect(button).to_be_disabled()
    page.get_by_label("What for").fill("endurance of axle 7")
    page.get_by_label("From", exact=True).fill(_local(-1))
    page.get_by_label("To", exact=True).fill(_local(2))
    button.click()
    expect(region(page, "Reservations")).to_contain_text("anna: endurance of axle 7")
    expect(region(page, "Reservations")).to_contain_text("now, until")
    expect(heading(page, re.compile("Reserved for anna until "))).to_be_visible()
    page.get_by_role("link", name="Operator panel").click()
    expect(heading(page, re.compile("Reserved for anna until "))).to_be_visible()
    refuse_hard_to_use(page)
    to(page, there, "benches")
    expect(page.locator(".card.bench")).to_contain_text("Reserved for anna until")
    expect(page.locator(".card.bench")).not_to_contain_text("Free")
    to(page, there, "wall")
    word = page.locator(".wall li.bench .state")
    expect(word).to_have_text("Reserved")
    assert word.evaluate("one => one.scrollWidth <= one.clientWidth")
    expect(page.locator(".wall li.bench")).to_contain_text("Reserved for anna until")
    to(page, there, "benches/sim")
    bert.queue(RunWanted(plan="short", bench="sim"))
    waiting = region(page, "Queue")
    expect(waiting).to_contain_text(
        re.compile("Waits for the reservation of anna until .*: endurance of axle 7")
    )
    expect(waiting).to_contain_text("Expected from")
    page.get_by_text("Write a note for the next shift").click()
    choice(page, "Shift").select_option("late")
    page.get_by_role("textbox", name="Note for the next shift").fill("oil changed\nleft sensor drifts")
    page.get_by_role("button", name="Leave the note").click()
    expect(region(page, "Hand-over")).to_contain_text("left sensor drifts")
    expect(region(page, "Hand-over")).to_contain_text("anna, late shift of")
    refuse_hard_to_use(page)


def test_whoever_has_the_bench_lets_a_run_start(page: playwright.Page, there: Served) -> None:
    anna, bert = Client(there.url, there.token), Client(there.url, _secret(there.data, "bert", "operator"))
    now = datetime.datetime.now(datetime.UTC)
    hour = datetime.timedelta(hours=1)
    anna.reserve("sim", now - hour, now + hour, "endurance")
    run = bert.queue(RunWanted(plan="short", bench="sim"))
    _enter(page, there, there.token, "Reserved for anna until")
    page.get_by_role("button", name=f"Let it start: run {run.id}").click()
    *_, last = bert.progress(run.id)
    assert last.verdict == "pass"
    page.get_by_role("button", name=re.compile("Remove the reservation of anna")).click()
    answer(page, "Remove")
    expect(region(page, "Reservations")).to_contain_text("Nobody has reserved the bench.")


@pytest.mark.parametrize("refusals", [("401 (Unauthorized)", "409 (Conflict)")])
def test_a_reservation_that_is_refused_says_so_at_its_form(page: playwright.Page, there: Served) -> None:
    bert = Client(there.url, _secret(there.data, "bert", "operator"))
    now = datetime.datetime.now(datetime.UTC)
    bert.reserve("sim", now, now + datetime.timedelta(hours=3), "cold start")
    _enter(page, there, there.token, "Reserved for bert until")
    page.get_by_text("Reserve the bench", exact=True).click()
    form = page.locator("form").filter(has=page.get_by_label("What for"))
    form.get_by_label("What for").fill("endurance")
    form.get_by_role("button", name="Reserve", exact=True).click()
    expect(form.get_by_role("alert")).to_contain_text("bert has reserved the bench from")
    expect(page.get_by_role("alert")).to_have_count(1)
    refuse_hard_to_use(page)
    form.get_by_label("What for").fill("endurance of axle 7")  # what is typed since is another wish
    expect(page.get_by_role("alert")).to_have_count(0)


def test_the_panel_shows_the_newest_note(page: playwright.Page, there: Served) -> None:
    today = f"{datetime.date.today()}"
    there.post("/benches/sim/handovers", {"day": today, "shift": "early", "text": "all quiet"})
    there.post("/benches/sim/handovers", {"day": today, "shift": "late", "text": "sensor drifts"})
    _enter(page, there, there.token)
    page.get_by_text("Earlier notes").click()
    expect(region(page, "Hand-over")).to_contain_text("all quiet")
    page.get_by_role("link", name="Operator panel").click()
    expect(page.get_by_text("sensor drifts")).to_be_visible()
    expect(page.get_by_text("all quiet")).to_be_hidden()


def _local(hours: float) -> str:
    """A moment so many hours from now as a field of a form has it."""
    return f"{datetime.datetime.now() + datetime.timedelta(hours=hours):%Y-%m-%dT%H:%M}"
