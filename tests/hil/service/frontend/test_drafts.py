"""What is typed and not saved: kept over a reload, asked about, and never saved over another's."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, choice, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
FIRST = SHORT.replace("name: short", "name: shared")
_RESTORED = "What you typed and did not save is restored"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("drafts")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        yield service


@pytest.fixture
def refusals() -> tuple[str, ...]:
    return ("401 (Unauthorized)", "409 (Conflict)")


@pytest.fixture
def asked(page: playwright.Page) -> list[str]:
    """What the browser has asked in a window of its own, each of which was declined."""
    questions: list[str] = []

    def decline(dialog: playwright.Dialog) -> None:
        questions.append(dialog.type)
        dialog.dismiss()

    page.on("dialog", decline)
    return questions


def _typed(page: playwright.Page, label: str, was: str, becomes: str) -> playwright.Locator:
    text = page.get_by_label(label)
    expect(text).to_have_value(re.compile(re.escape(was)))
    text.fill(text.input_value().replace(was, becomes))
    return text


def test_a_plan_that_was_typed_outlives_a_reload_and_is_discarded_when_one_says_so(
    page: playwright.Page, there: Served
) -> None:
    there.give("shared", FIRST)
    to(page, there, "plans/shared?write=on")
    _typed(page, "Text of the plan", "upper: 400", "upper: 371")
    page.reload()
    text = page.get_by_label("Text of the plan")
    expect(text).to_have_value(re.compile("upper: 371"))
    notice = page.get_by_text(_RESTORED)
    expect(notice).to_be_visible()
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Discard it").click()
    answer(page, "Discard it")
    expect(text).to_have_value(re.compile("upper: 400"))
    expect(notice).to_have_count(0)
    page.reload()
    expect(text).to_have_value(re.compile("upper: 400"))
    expect(notice).to_have_count(0)


def test_leaving_what_is_not_saved_is_asked_about(
    page: playwright.Page, there: Served, asked: list[str]
) -> None:
    there.give("shared", FIRST)
    to(page, there, "plans/shared")
    page.get_by_role("link", name="Edit", exact=True).click()
    text = _typed(page, "Text of the plan", "upper: 400", "upper: 372")
    page.get_by_role("link", name="Runs", exact=True).first.click()
    answer(page, "Stay here")
    expect(text).to_be_visible()
    page.go_back()
    answer(page, "Stay here")
    expect(text).to_have_value(re.compile("upper: 372"))
    assert page.url.endswith("write=on")
    page.evaluate("location.reload()")
    expect(text).to_have_value(re.compile("upper: 372"))
    expect(page.get_by_text(_RESTORED)).to_have_count(0)  # it was never left
    assert asked == ["beforeunload"]
    text.fill(text.input_value().replace("upper: 372", "upper: 400"))
    page.get_by_role("link", name="Runs", exact=True).first.click()
    expect(heading(page, "Runs")).to_be_visible()  # nothing would be lost
    assert len(asked) == 1


def test_a_step_back_that_is_agreed_to_goes_where_it_went(
    page: playwright.Page, there: Served, asked: list[str]
) -> None:
    there.give("shared", FIRST)
    to(page, there, "runs")
    page.get_by_role("link", name="Plans", exact=True).first.click()
    page.get_by_role("link", name="shared", exact=True).click()
    page.get_by_role("link", name="Edit", exact=True).click()
    _typed(page, "Text of the plan", "upper: 400", "upper: 385")
    page.go_back()
    answer(page, "Leave it")
    expect(page).to_have_url(re.compile("/plans/shared$"))
    expect(page.get_by_label("Text of the plan")).to_have_count(0)
    page.go_back()
    expect(heading(page, "Plans")).to_be_visible()
    page.go_back()
    expect(heading(page, "Runs")).to_be_visible()
    assert asked == []


def test_a_saved_text_leaves_no_draft(page: playwright.Page, there: Served, asked: list[str]) -> None:
    there.give("shared", FIRST)
    to(page, there, "plans/shared?write=on")
    text = _typed(page, "Text of the plan", "upper: 400", "upper: 373")
    text.fill(text.input_value().replace("default: 100", "default: 123"))
    page.get_by_role("button", name="Keep as shared").click()
    expect(heading(page, "shared")).to_be_visible()
    expect(region(page, "Variables, table")).to_contain_text("123 N m")  # as it is now
    page.get_by_role("link", name="Edit", exact=True).click()
    expect(page.get_by_label("Text of the plan")).to_have_value(re.compile("upper: 373"))
    expect(page.get_by_text(_RESTORED)).to_have_count(0)
    assert asked == []


def test_another_text_that_was_saved_meanwhile_is_shown_before_it_is_replaced(
    page: playwright.Page, there: Served
) -> None:
    there.give("shared", FIRST)
    to(page, there, "plans/shared?write=on")
    _typed(page, "Text of the plan", "upper: 400", "upper: 374")
    there.give("shared", FIRST.replace("to_nm: $torque_nm", "to_nm: 50"))
    page.get_by_role("button", name="Keep as shared").click()
    found = region(page, "Another text was saved meanwhile")
    expect(found).to_contain_text("local saved shared")
    difference = page.get_by_role("region", name="Differences, from their text to yours")
    expect(difference.locator(".gone")).to_contain_text(["to_nm: 50", "upper: 400"])
    expect(difference.locator(".new")).to_contain_text(["to_nm: $torque_nm", "upper: 374"])
    refuse_hard_to_use(page)
    assert "to_nm: 50" in there.get("/plans/shared/text").decode()
    found.get_by_role("button", name="Keep mine as the newer version").click()
    expect(heading(page, "shared")).to_be_visible()
    assert "upper: 374" in there.get("/plans/shared/text").decode()
    assert there.get("/versions/plan/shared")[0]["number"] >= 3  # theirs is there, too


def test_the_message_of_another_text_is_in_sight_and_has_the_focus(
    page: playwright.Page, there: Served
) -> None:
    there.give("shared", FIRST)
    to(page, there, "plans/shared?write=on")
    _typed(page, "Text of the plan", "upper: 400", "upper: 377")
    there.give("shared", FIRST.replace("upper: 400", "upper: 391"))
    page.set_viewport_size({"width": 390, "height": 500})
    page.get_by_role("button", name="Keep as shared").click()
    notice = page.get_by_role("alert").filter(has_text="local saved shared")
    expect(notice).to_be_in_viewport()
    expect(notice).to_be_focused()
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="Keep mine as the newer version")).to_be_focused()


def test_what_is_saved_in_another_tab_takes_no_draft_away(browser: playwright.Browser, there: Served) -> None:
    there.give("shared", FIRST)
    with browser.new_context(locale="en-US") as context:
        page, second = context.new_page(), context.new_page()
        to(page, there, "plans/shared?write=on")
        text = _typed(page, "Text of the plan", "upper: 400", "upper: 378")
        to(second, there, "plans/shared?write=on")
        _typed(second, "Text of the plan", "upper: 378", "upper: 379")  # what was typed is there, too
        second.get_by_role("button", name="Keep as shared").click()
        expect(heading(second, "shared")).to_be_visible()
        page.on("dialog", lambda dialog: dialog.accept())
        page.reload()
        expect(text).to_have_value(re.compile("upper: 378"))
        expect(page.get_by_text(_RESTORED)).to_be_visible()


def test_a_draft_of_a_tab_that_was_closed_is_restored_in_another_once(
    browser: playwright.Browser, there: Served
) -> None:
    there.give("shared", FIRST)
    with browser.new_context(locale="en-US") as context:
        first = context.new_page()
        to(first, there, "plans/shared?write=on")
        _typed(first, "Text of the plan", "upper: 400", "upper: 380")
        first.close()
        page = context.new_page()
        to(page, there, "plans/shared?write=on")
        text = page.get_by_label("Text of the plan")
        expect(text).to_have_value(re.compile("upper: 380"))
        page.get_by_role("button", name="Discard it").click()
        answer(page, "Discard it")
        page.reload()
        expect(text).to_have_value(re.compile("upper: 400"))


def test_theirs_is_taken_and_written_on_from(page: playwright.Page, there: Served) -> None:
    there.give("shared", FIRST)
    to(page, there, "plans/shared?write=on")
    text = _typed(page, "Text of the plan", "upper: 400", "upper: 375")
    there.give("shared", FIRST.replace("upper: 400", "upper: 390"))
    page.reload()  # the draft is of the text before
    expect(page.get_by_text("The text at the service has changed since")).to_be_visible()
    page.get_by_role("button", name="Keep as shared").click()
    page.get_by_role("button", name="Discard mine and take theirs").click()
    answer(page, "Discard it")
    expect(text).to_have_value(re.compile("upper: 390"))
    expect(page.get_by_text(_RESTORED)).to_have_count(0)
    _typed(page, "Text of the plan", "upper: 390", "upper: 391")
    page.get_by_role("button", name="Keep as shared").click()
    expect(heading(page, "shared")).to_be_visible()
    assert "upper: 391" in there.get("/plans/shared/text").decode()


def test_a_plan_that_is_given_replaces_another_only_when_one_says_so(
    page: playwright.Page, there: Served
) -> None:
    there.give("shared", FIRST)
    to(page, there, "plans")
    part = region(page, "Give a plan")
    part.get_by_label("Name").fill("shared")
    part.get_by_label("Text").fill(FIRST.replace("upper: 400", "upper: 376"))
    part.get_by_role("button", name="Give the plan").click()
    expect(region(page, "Another text was saved meanwhile")).to_be_visible()
    assert "upper: 400" in there.get("/plans/shared/text").decode()
    page.get_by_role("button", name="Keep mine as the newer version").click()
    expect(heading(page, "shared")).to_be_visible()
    assert "upper: 376" in there.get("/plans/shared/text").decode()


def test_a_model_that_took_the_name_meanwhile_is_shown(page: playwright.Page, there: Served) -> None:
    to(page, there, "models?write=new")
    text = _typed(page, "Text of the model", "shaft_stiffness = 6089.0", "shaft_stiffness = 3100.0")
    page.get_by_label("Name", exact=True).fill("axle")
    expect(page.get_by_text("No mistake was found.")).to_be_visible(timeout=120_000)
    theirs = text.input_value().replace("3100.0", "3200.0")
    there.ask("PUT", "/api/v1/models/axle", theirs)
    page.get_by_role("button", name="Keep as axle").click()
    expect(region(page, "Another text was saved meanwhile")).to_contain_text("local saved axle")
    page.get_by_role("button", name="Keep mine as axle_2").click()
    expect(heading(page, "axle_2")).to_be_visible()
    assert "3100.0" in there.get("/models/axle_2/text").decode()
    assert "3200.0" in there.get("/models/axle/text").decode()


def test_a_campaign_that_was_typed_outlives_a_reload(page: playwright.Page, there: Served) -> None:
    to(page, there, "campaigns")
    choice(page, "Campaign").select_option("own file")
    page.get_by_label("Content").fill("name: half_written")
    page.reload()
    expect(page.get_by_text(_RESTORED)).to_be_visible()
    expect(page.get_by_label("Content")).to_have_value("name: half_written")
    expect(choice(page, "Campaign")).to_have_value("own file")
