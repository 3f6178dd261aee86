"""The built page in a browser, against the real service on the simulated bench."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from hil.service.serving import make_token
from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, heading, region, reset_stop, to
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import ASKING, SHORT, Served, environment_of, served

pytestmark = IN_A_BROWSER
#: Time enough before its question for all that was measured to be written.
_LATER = ASKING.replace("name: asking", "name: asking\ntitle: A plan that asks").replace(
    "  - operator_prompt", "  - wait: {duration_s: 5}\n  - operator_prompt"
)

_PEAKS = re.compile(r"shaft torque of runs 1, 2 from the step; largest \d+, \d+ N m")
_ASKED = re.compile(r"driving torque ref of runs 1, 2 .* largest 100, 150 N m")


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with two runs that ended, of 100 and of 150 N m, and one of a plan with a long title."""
    folder = tmp_path_factory.mktemp("app")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("asking", _LATER)
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        for torque_nm in (100, 150):
            service.over(service.queue(values={"torque_nm": torque_nm}))
        service.give("long", SHORT.replace("name: short", f"name: long\ntitle: {'W' * 100}"))
        service.over(service.queue("long"))  # a name that has no place to break
        yield service


def test_a_plan_is_foreseen_queued_watched_stopped_and_found(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    choice(page, "Plan").select_option("asking")
    expect(page.locator(".forecast")).to_contain_text("Fits the bench", timeout=180_000)
    expect(page.locator(".forecast")).to_contain_text("motor speed")
    page.get_by_role("button", name="Queue the run").click()
    expect(heading(page, re.compile("A plan that asks"))).to_be_visible()
    run = int(page.url.rpartition("/")[2])
    expect(page.get_by_text("Is the cage shut?")).to_be_visible()
    expect(page.locator(".chip", has_text="motor speed").first).to_contain_text("rad/s")
    expect(region(page, "Criteria")).to_contain_text("s.peak_shaft_torque")
    page.get_by_role("button", name="Emergency stop sim").click()
    there.over(run)
    expect(page.get_by_text("stopped", exact=True)).to_be_visible()
    expect(region(page, "Segments and events")).to_contain_text("safe stateconfirmed")
    expect(page.locator(".facts")).to_contain_text("safe stateconfirmed")
    with page.expect_popup() as report:
        page.get_by_role("link", name="report", exact=True).click()
    expect(heading(report.value, re.compile("A plan that asks"))).to_be_visible()
    report.value.close()
    to(page, there, "#sim")  # as the former page had it
    reset_stop(page, there, region(page, "State of sim"))
    expect(heading(page, "Free")).to_be_visible()


def test_no_plan_is_chosen_beforehand_but_the_last_that_this_person_ran(
    tmp_path: Path, page: playwright.Page
) -> None:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        to(page, service, "benches/sim")
        plan = choice(page, "Plan")
        expect(plan.locator("option", has_text="abs_release: Regeneration")).to_be_attached()
        expect(plan).to_have_value("")
        expect(page.get_by_role("button", name="Queue the run")).to_be_disabled()
        plan.select_option("abs_release")
        expect(page.get_by_text("Largest torque asked for: 200")).to_contain_text("at the wheels")
        service.give("short", SHORT)
        service.over(service.queue("short"))
        to(page, service, "benches/sim")
        expect(plan).to_have_value("short")
        page.goto("about:blank")


def test_a_run_is_queued_and_ended_by_keyboard_alone(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    plan = choice(page, "Plan")
    expect(plan).to_contain_text("A plan that asks")
    plan.focus()
    page.keyboard.press("Home")
    while plan.input_value() != "asking":  # not by its letters: a slow machine takes them for several words
        page.keyboard.press("ArrowDown")
    button = page.get_by_role("button", name="Queue the run")
    expect(button).to_be_enabled(timeout=180_000)
    page.keyboard.press("Tab")
    while not button.evaluate("one => one === document.activeElement"):
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(page.get_by_text("Is the cage shut?")).to_be_visible()
    page.get_by_role("button", name="End the run", exact=True).focus()
    page.keyboard.press("Enter")
    expect(region(page, "Why it did not pass")).to_contain_text("stopped by the operator")


def test_a_service_without_news_is_not_taken_for_lost(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    expect(heading(page, "Free")).to_be_visible()
    page.evaluate(
        """async () => {
          const events = new EventSource("/api/v1/benches/sim/live");
          const here = () => new Promise((heard) => events.addEventListener("here", heard, { once: true }));
          for (let times = 0; times < 9; times++) await here();
          events.close();
        }"""  # nine times two seconds without news: longer than the page waits for a word
    )
    expect(page.get_by_text("The service does not answer")).to_be_hidden()


def test_a_question_is_answered_on_the_operator_panel(page: playwright.Page, there: Served) -> None:
    run = there.queue("asking")
    to(page, there, "benches/sim/panel")
    expect(page.get_by_text("Is the cage shut?")).to_be_visible()
    expect(page.locator(".dials")).to_contain_text("limit ±700")
    page.get_by_label("Remark").fill("yes")
    page.keyboard.press("Enter")
    assert there.over(run)["verdict"] == "pass"
    expect(heading(page, "Free")).to_be_visible()


@pytest.mark.parametrize(
    ("address", "name"),
    [
        ("benches", "Benches"),
        ("benches/sim", "Free"),
        ("benches/sim/panel", "Free"),
        ("runs?plan=short", "Runs"),
        ("runs/1", re.compile("A short plan")),
        ("compare?runs=1,2", "Compare runs"),
        ("trends?bench=sim&plan=short", "Trends"),
        ("plans", "Plans"),
        ("plans/acceptance", re.compile("Vibration suppression")),
        ("models", "Models"),
        ("controllers", "Controllers"),
        ("controllers/phase_stabilization", "phase_stabilization"),
        ("identifications", "Identifications"),
        ("diagnoses", "Diagnoses"),
        ("campaigns", "Campaigns"),
        ("audit", "Audit log"),
        ("settings", "Settings"),
        ("glossary", "Words of this page"),
        ("controllers?write=new", "Write a controller"),
        ("nothing", "No such page"),
    ],
)
def test_each_address_shows_its_view_again_after_a_reload_and_is_easy_to_use(
    page: playwright.Page, there: Served, address: str, name: str | re.Pattern[str]
) -> None:
    to(page, there, address)
    expect(heading(page, name)).to_be_visible()
    title = page.title()
    page.reload()
    expect(heading(page, name)).to_be_visible()
    assert (page.title(), page.url) == (title, f"{there.url}/{address}")
    expect(page.locator("main").get_by_text("Loading")).to_have_count(0)
    page.mouse.wheel(0, 5000)
    expect(page.get_by_role("button", name=re.compile("Emergency stop"))).to_be_in_viewport()
    refuse_hard_to_use(page)


def test_the_browser_goes_back_and_forward_between_views(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches")
    page.get_by_role("link", name="Runs").click()
    page.get_by_role("link", name="1", exact=True).click()
    expect(heading(page, re.compile("A short plan"))).to_be_visible()
    page.go_back()
    expect(heading(page, "Runs")).to_be_visible()
    page.go_back()
    expect(heading(page, "Benches")).to_be_visible()
    page.go_forward()
    page.go_forward()
    expect(page).to_have_title(re.compile("^Run 1 "))


def test_the_palette_finds_by_keyboard_alone(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches")
    expect(heading(page, "Benches")).to_be_visible()
    for words, url in (
        ("acceptance", "/plans/acceptance"),
        ("run 2", "/runs/2"),
        ("sim", "/benches/sim"),
    ):
        page.keyboard.press("Control+k")
        page.keyboard.type(words)
        chosen = page.get_by_role("dialog").locator("[aria-selected=true]")
        expect(chosen).to_contain_text(re.compile(f"^{words} ", re.IGNORECASE))
        page.keyboard.press("Enter")
        expect(page).to_have_url(there.url + url)
    page.keyboard.press("Control+k")
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)


def test_runs_are_filtered_sorted_and_compared(page: playwright.Page, there: Served) -> None:
    to(page, there, "runs?plan=short")
    rows = page.locator("tbody tr")
    expect(rows.first).to_contain_text("torque_nm = 150")
    page.get_by_label("Criterion").select_option("s.peak_shaft_torque")
    page.get_by_role("button", name="s.peak_shaft_torque").click()
    page.get_by_role("button", name="s.peak_shaft_torque").click()
    expect(rows.first).to_contain_text("torque_nm = 100")
    assert "sort=value&rising=true" in page.url
    page.get_by_label("at least").fill("120")
    expect(rows).to_have_count(1)
    page.get_by_role("button", name="Clear all").click()
    for run in (1, 2):
        page.get_by_label(f"Compare run {run}", exact=True).check()
    page.reload()
    expect(page.get_by_text("2 chosen")).to_be_visible()
    page.get_by_role("button", name="Compare", exact=True).click()
    expect(page.locator(".differs")).to_contain_text("torque_nm 150 instead of 100 N m")
    criteria = region(page, "Criteria").locator("table").first
    expect(criteria.get_by_role("columnheader", name="run 2 − run 1")).to_be_visible()
    expect(criteria.get_by_role("row", name=re.compile("Peak of the shaft torque"))).to_contain_text(
        re.compile(r"≤.400.N.m.*\+\d.*N.m \(\+\d.*%\)worse")
    )
    expect(criteria.get_by_role("row", name=re.compile("s.arrival"))).not_to_contain_text("worse")
    expect(page.get_by_text("Criteria of run 2 against run 1")).to_be_visible()
    plots = page.locator("figure.plot")
    expect(plots.first.get_by_role("img", name=_PEAKS)).to_be_visible()
    for at in range(3):
        expect_drawn(plots.nth(at), "gain", "phase")
    choice(page, "Stretch").select_option("whole")
    choice(page, "Channel").select_option("driving_torque_ref_nm")
    expect(page.get_by_role("img", name=_ASKED)).to_be_visible()
    refuse_hard_to_use(page)


def test_a_given_recording_is_laid_beside_a_run_from_its_step(page: playwright.Page, there: Served) -> None:
    to(page, there, "recordings")
    page.get_by_label("File of a recording").set_input_files(there.data / "runs/000002/recording.mcap")
    page.get_by_role("button", name="Give the recording").click()
    expect(heading(page, re.compile("recording.mcap ready"))).to_be_visible()
    marks = there.get("/runs/2/view")["marks"]
    step_s = next(mark["step_s"] for mark in marks if mark["kind"] == "segment")
    to(page, there, "compare?runs=1")
    choice(page, "Given recording").select_option("1")
    page.get_by_label("step at, s").fill(f"{step_s:g}")
    page.keyboard.press("Tab")
    expect(page).to_have_url(re.compile(f"recordings=1%40{step_s:g}|recordings=1@{step_s:g}"))
    drawn = page.get_by_role(
        "img", name=re.compile(r"shaft torque of runs 1, recording 1 .* largest 1\d\d, 1\d\d")
    )
    expect(drawn).to_be_visible()
    expect_drawn(page.locator("figure.plot").first, "gain", "phase")
    refuse_hard_to_use(page)


def test_what_is_seen_of_a_run_stands_in_its_address(page: playwright.Page, there: Served) -> None:
    to(page, there, "runs/1")
    plots = page.locator("figure.plot")
    expect(plots).to_have_count(4)
    page.locator(".channels li", has_text="wheel speed left").drag_to(plots.first)
    expect(plots.first).to_contain_text("wheel speed left")
    page.get_by_label("Put vehicle speed onto a plot").select_option("1")
    expect(plots.nth(1)).to_contain_text("vehicle speed")
    over = plots.nth(1).locator(".u-over").bounding_box()
    assert over is not None
    page.mouse.move(over["x"] + 0.4 * over["width"], over["y"] + 50)
    page.mouse.down()
    page.mouse.move(over["x"] + 0.6 * over["width"], over["y"] + 50, steps=4)
    page.mouse.up()
    expect(page).to_have_url(re.compile(r"t=\d"))
    page.get_by_role("button", name="Add a cursor").click()
    page.locator(".plot-place").first.focus()
    page.keyboard.press("c")
    page.keyboard.press("ArrowRight")
    cursors = page.get_by_role("region", name="Values at the cursors")
    expect(cursors).to_contain_text("B − A")
    expect(cursors.get_by_role("row", name=re.compile("shaft torque"))).to_contain_text("N m")
    page.wait_for_load_state("networkidle")  # values of the stretch that was zoomed to
    seen, sent = cursors.inner_text(), page.url
    page.goto("about:blank")
    page.goto(sent)
    expect(cursors).to_have_text(re.compile("shaft torque"))
    expect(plots.first).to_contain_text("wheel speed left")
    page.wait_for_function("text => document.querySelector('.cursors table')?.innerText === text", arg=seen)


def test_a_cursor_that_is_dragged_is_written_to_the_address_at_rest_only(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "runs/1?c=1")
    cursors = page.get_by_role("region", name="Values at the cursors")
    expect(cursors).to_contain_text("1.000")
    page.evaluate(
        """() => {
          window.written = 0;
          const replace = history.replaceState.bind(history);
          history.replaceState = (...all) => { window.written += 1; replace(...all); };
        }"""
    )
    page.wait_for_load_state("networkidle")
    page.locator(".plot-place").first.focus()
    for _ in range(8):
        page.keyboard.press("ArrowRight")
    expect(cursors).not_to_contain_text("1.000")
    page.wait_for_function("() => window.written > 0")
    assert page.evaluate("window.written") < 8
    shown = cursors.locator("tbody tr").first.inner_text()
    page.reload()
    expect(cursors.locator("tbody tr").first).to_have_text(shown.replace("\t", ""))


def test_a_run_is_asked_for_again_with_another_value(page: playwright.Page, there: Served) -> None:
    to(page, there, "runs/2")
    page.get_by_role("link", name="Again with other values").click()
    expect(heading(page, re.compile("A short plan"))).to_be_visible()
    value = page.get_by_role("textbox", name="torque_nm in N m")
    expect(value).to_have_value("150")
    value.fill("120")
    button = page.get_by_role("button", name="Queue the run")
    expect(button).to_be_enabled(timeout=180_000)
    button.click()
    expect(page.locator(".facts")).to_contain_text("torque_nm = 120")
    there.over(int(page.url.rpartition("/")[2]))


def test_a_run_is_queued_while_it_is_still_being_predicted(page: playwright.Page, there: Served) -> None:
    page.route("**/api/v1/forecasts", lambda _: None)  # never answered
    to(page, there, "plans/short")
    expect(page.get_by_text("Predicting duration and peaks")).to_be_visible()
    page.get_by_role("button", name="Queue the run").click()
    expect(page).to_have_url(re.compile(r"/runs/\d+$"))
    there.over(int(page.url.rpartition("/")[2]))


def test_a_narrow_page_has_all_lists_behind_a_button_and_long_notes_are_folded(
    page: playwright.Page, there: Served
) -> None:
    there.post("/runs/1/notes", {"text": "\n".join(f"line {number} of many" for number in range(40))})
    page.set_viewport_size({"width": 390, "height": 900})
    to(page, there, "runs/1")
    note = page.get_by_role("article", name=re.compile("Note of")).locator(".written")
    expect(note).to_be_visible()
    folded = note.bounding_box()
    page.get_by_role("button", name="Show all of it").click()
    shown = note.bounding_box()
    assert folded is not None
    assert shown is not None
    assert 4 * folded["height"] < shown["height"]
    settings = page.get_by_role("link", name="Settings")
    expect(settings).to_be_hidden()
    page.get_by_role("button", name="Pages: Runs").click()
    refuse_hard_to_use(page)
    page.set_viewport_size({"width": 390, "height": 900})
    settings.click()
    expect(heading(page, "Settings")).to_be_visible()
    expect(page.get_by_role("button", name="Pages: Settings")).to_have_attribute("aria-expanded", "false")


def test_who_has_no_token_can_stop_and_see_nothing(tmp_path: Path, page: playwright.Page) -> None:
    database = environment_of(tmp_path / "data")["HIL_DATABASE"]
    made = make_token(tmp_path / "data", database, "anna", "viewer")
    with served(tmp_path / "data", state=tmp_path / "state", token=made.secret) as service:
        to(page, service, "benches/sim")
        expect(heading(page, "Sign in")).to_be_visible()
        page.get_by_role("button", name="Emergency stop all benches").click()
        page.get_by_label("Token").fill(made.secret)
        page.get_by_role("button", name="Sign in").click()
        expect(heading(page, "Emergency stop")).to_be_visible()
        expect(page.get_by_text("anna, viewer")).to_be_visible()
        assert page.get_by_role("button", name="It is safe: reset the emergency stop").is_hidden()
        assert page.get_by_role("heading", name="Start a plan").is_hidden()
        refuse_hard_to_use(page)
        page.get_by_role("button", name="Sign out").click()
        expect(heading(page, "Sign in")).to_be_visible()
        page.goto("about:blank")  # it would tell that the service has gone
