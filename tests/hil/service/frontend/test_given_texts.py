"""What people type at a run or a bench is kept until it is saved, never cut; an empty file is no gift."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, choice, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import ASKING, SHORT, Served, served

pytestmark = IN_A_BROWSER
_RESTORED = "What you typed and did not save is restored"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("given-texts")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT)
        service.over(service.queue())
        yield service


def test_a_note_outlives_leaving_and_a_reload_until_it_is_added(page: playwright.Page, there: Served) -> None:
    to(page, there, "runs/1")
    note = page.get_by_label("Note", exact=True)
    note.fill("the left shaft\nwas warm")
    page.get_by_role("link", name="Runs", exact=True).first.click()
    answer(page, "Leave it")
    expect(heading(page, "Runs")).to_be_visible()
    page.go_back()
    expect(note).to_have_value("the left shaft\nwas warm")
    expect(page.get_by_text(_RESTORED)).to_be_visible()
    page.once("dialog", lambda dialog: dialog.accept())
    page.reload()
    expect(note).to_have_value("the left shaft\nwas warm")
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Add the note").click()
    expect(page.get_by_role("article", name="Note of local")).to_contain_text("was warm")
    expect(note).to_have_value("")
    expect(page.get_by_text(_RESTORED)).to_have_count(0)
    page.reload()  # nobody is asked
    expect(note).to_have_value("")


def test_a_note_for_the_next_shift_outlives_a_reload(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    page.get_by_text("Write a note for the next shift").click()
    page.get_by_role("textbox", name="Note for the next shift").fill("oil changed")
    page.once("dialog", lambda dialog: dialog.accept())
    page.reload()
    page.get_by_text("Write a note for the next shift").click()
    expect(page.get_by_role("textbox", name="Note for the next shift")).to_have_value("oil changed")


def test_a_text_that_is_too_long_is_said_and_not_cut(page: playwright.Page, there: Served) -> None:
    to(page, there, "runs/1")
    part = region(page, "Tags and notes")
    tag, add = choice(page, "Tag"), part.get_by_role("button", name="Add", exact=True)
    tag.press_sequentially("endurance_of_axle_7_after_the_oil_was_changed")
    expect(tag).to_have_value("endurance_of_axle_7_after_the_oil_was_changed")
    expect(part.get_by_role("alert")).to_have_text("It has 45 letters; at most 40 are kept. Shorten it.")
    expect(add).to_be_disabled()
    refuse_hard_to_use(page)
    tag.fill("endurance_of_axle_7")
    expect(part.get_by_role("alert")).to_have_count(0)
    add.click()
    expect(part.get_by_role("link", name="endurance_of_axle_7")).to_be_visible()
    expect(tag).to_have_value("")
    note = page.get_by_label("Note", exact=True)
    note.fill("x" * 4001)
    expect(part.get_by_role("alert")).to_contain_text("It has 4001 letters; at most 4000 are kept.")
    expect(page.get_by_role("button", name="Add the note")).to_be_disabled()
    note.fill("")


def _pasted(page: playwright.Page, field: playwright.Locator, text: str) -> None:
    field.focus()
    page.keyboard.insert_text(text)
    expect(field).to_have_value(text)


def _refused(page: playwright.Page, most: int) -> None:
    said = f"It has {most + 50} letters; at most {most} are kept. Shorten it."
    expect(page.get_by_role("alert")).to_have_text(said)


def test_nothing_that_is_pasted_is_cut_and_the_limit_is_said(page: playwright.Page, there: Served) -> None:
    sent: list[str] = []
    page.on("request", lambda one: sent.append(one.url) if one.method in ("POST", "PUT") else None)
    there.give("asking", ASKING)
    run = there.queue("asking")
    there.until(run, lambda found: found["prompt"] is not None)
    try:
        to(page, there, "benches/sim")
        _pasted(page, page.get_by_label("Remark"), "y" * 550)
        _refused(page, 500)
        page.keyboard.press("Enter")
        page.get_by_label("Remark").fill("")
        page.get_by_text("Reserve the bench", exact=True).click()
        _pasted(page, page.get_by_label("What for"), "endurance " * 25)
        _refused(page, 200)
        refuse_hard_to_use(page)
        expect(page.get_by_role("button", name="Reserve", exact=True)).to_be_disabled()
    finally:
        there.post(f"/runs/{run}/abort")
        there.over(run)
    to(page, there, "controllers?write=new")
    _pasted(page, page.get_by_label("Name", exact=True), "n" * 114)
    _refused(page, 64)
    expect(page.get_by_role("button", name="Keep it")).to_be_disabled()
    to(page, there, "runs")
    _pasted(page, page.get_by_label("Words"), "w" * 250)
    _refused(page, 200)
    assert [url for url in sent if re.search("/(answer|reservations|controllers/.*)$", url)] == []


@pytest.mark.parametrize("refusals", [("422 (Unprocessable",)])
def test_an_answer_that_was_refused_stays_in_its_field(page: playwright.Page, there: Served) -> None:
    there.give("asking", ASKING)
    run = there.queue("asking")
    there.until(run, lambda found: found["prompt"] is not None)
    try:
        to(page, there, "benches/sim")
        page.get_by_label("Remark").fill("bell \x85")  # no character of a line
        page.get_by_role("button", name="Continue", exact=True).click()
        expect(page.get_by_role("alert")).to_contain_text("has characters that it must not have")
        expect(page.get_by_label("Remark")).to_have_value("bell \x85")
        page.get_by_label("Remark").fill("yes")
        page.get_by_role("button", name="Continue", exact=True).click()
        expect(page.get_by_role("region", name="Question")).to_have_count(0)
    finally:
        there.over(run)


@pytest.mark.parametrize("refusals", [("503 (Service Unavailable)",)])
def test_what_was_refused_stays_in_its_field(page: playwright.Page, there: Served) -> None:
    def refuse(route: playwright.Route) -> None:
        answer = '{"what": "the store failed", "where": "", "fix": ""}'
        if route.request.method == "GET":
            route.continue_()
        else:
            route.fulfill(status=503, content_type="application/json", body=answer)

    to(page, there, "runs/1")
    page.route(re.compile("/runs/1/(tags|notes)"), refuse)
    choice(page, "Tag").fill("warm")
    page.get_by_role("button", name="Add", exact=True).click()
    expect(page.get_by_role("alert")).to_contain_text("the store failed")
    expect(choice(page, "Tag")).to_have_value("warm")
    note = page.get_by_label("Note", exact=True)
    note.fill("warm")
    page.get_by_role("button", name="Add the note").click()
    expect(page.get_by_role("alert")).to_contain_text("the store failed")
    expect(note).to_have_value("warm")
    note.fill("")


@pytest.mark.parametrize(
    ("address", "label", "name", "content", "button"),
    [
        ("recordings", "File of a recording", "drive.csv", "", "Give the recording"),
        ("models", "File (.toml)", "axle.toml", "", "Give a model"),
        ("models", "File (.toml)", "axle.toml", " \n", "Give a model"),
    ],
)
def test_an_empty_file_is_refused_and_leaves_nothing(
    address: str, label: str, name: str, content: str, button: str,
    page: playwright.Page, there: Served, tmp_path: Path,
) -> None:  # fmt: skip
    path = tmp_path / name
    path.write_text(content)
    to(page, there, address)
    field = page.get_by_label(label)
    field.set_input_files(path)
    expect(page.get_by_role("alert")).to_contain_text(f"The file {name} is empty and was not taken.")
    expect(field).to_have_value("")
    expect(page.get_by_role("button", name=button)).to_be_disabled()
    if address == "models":
        expect(page.get_by_label("Name", exact=True)).to_have_value("")
    assert "axle" not in [one["name"] for one in there.get("/models")]
    assert there.get("/recordings") == []
