"""The page in German and Japanese: chosen or the browser's, whole, and as easy to use as in English."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, heading, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
ADDRESSES = (
    "benches",
    "benches/sim",
    "benches/sim/panel",
    "wall",
    "wall/sim",
    "runs?criterion=s.peak_shaft_torque",
    "runs/1",
    "compare?runs=1,2",
    "trends?bench=sim&plan=short",
    "plans",
    "plans/acceptance",
    "plans?write=new",
    "models",
    "models/three_inertia?write=on",
    "controllers",
    "controllers?write=new",
    "bench-files",
    "bench-files?write=new",
    "recordings",
    "design",
    "identifications",
    "diagnoses",
    "campaigns",
    "audit",
    "settings",
    "glossary",
    "nothing",
)


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with two runs that ended."""
    folder = tmp_path_factory.mktemp("languages")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        for torque_nm in (100, 150):
            service.over(service.queue(values={"torque_nm": torque_nm}))
        yield service


IN_GERMAN = pytest.mark.parametrize("locale", ["de-CH"])


@IN_GERMAN
def test_the_browsers_language_is_taken_and_another_is_chosen_in_the_settings(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "settings")
    expect(heading(page, "Einstellungen")).to_be_visible()
    expect(page.locator("html")).to_have_attribute("lang", "de")
    choice(page, "Sprache").select_option("日本語")
    expect(heading(page, "設定")).to_be_visible()
    page.reload()
    expect(page.locator("html")).to_have_attribute("lang", "ja")
    fonts = page.evaluate("getComputedStyle(document.body).fontFamily")  # of macOS, Windows and Linux
    assert all(name in fonts for name in ("Hiragino Sans", "Yu Gothic", "Noto Sans CJK JP"))
    choice(page, "言語").select_option("")
    expect(heading(page, "Einstellungen")).to_be_visible()


@pytest.mark.parametrize(
    ("locale", "name"), [("en", "Bench sim Free"), ("de", "Prüfstand sim Frei"), ("ja", "sim")]
)
def test_the_menu_is_one_line_beside_a_scroll_bar_and_a_bench_is_named(
    page: playwright.Page, there: Served, name: str
) -> None:
    page.set_viewport_size({"width": 1280 - 15, "height": 900})
    to(page, there, "benches/sim")
    expect(heading(page, name)).to_be_visible()
    assert "sim" in page.title()
    shown = "[...element.querySelectorAll('a')].filter((one) => one.offsetParent)"
    lines = f"element => new Set({shown}.map((one) => one.offsetTop)).size"
    for menu in page.get_by_role("navigation").all():
        assert menu.evaluate(lines) == 1
    assert page.locator("header a").filter(visible=True).count() == 16  # the lists, what is aside, the home


def test_readers_of_english_load_no_catalogue(page: playwright.Page, there: Served) -> None:
    loaded: list[str] = []
    page.on("request", lambda request: loaded.append(request.url))
    to(page, there, "benches")
    expect(heading(page, "Benches")).to_be_visible()
    assert [url for url in loaded if re.search(r"/assets/(de|ja)-", url)] == []
    assert len([url for url in loaded if url.endswith(".js")]) == 1


@IN_GERMAN
def test_numbers_and_moments_are_those_of_the_language_and_iso_where_the_pointer_stays(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "runs?criterion=s.peak_shaft_torque")
    row = page.locator("tbody tr").first
    expect(row).to_contain_text("bestanden")
    ended = row.locator("time")
    expect(ended).to_have_text(re.compile(r"^\d\d\.\d\d\.\d{4}, \d\d:\d\d$"))
    expect(ended).to_have_attribute("title", re.compile(r"^\d{4}-\d\d-\d\dT"))


@IN_GERMAN
def test_words_of_the_service_are_translated_where_known_and_read_out_as_english_elsewhere(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "runs/1")
    events = page.get_by_role("region", name="Abschnitte und Ereignisse", exact=True)
    expect(events.get_by_text("bestätigt durch RMCU und Dynamometer")).to_be_visible()
    expect(events.get_by_text("Vorprüfung")).to_be_visible()
    assert events.locator("[lang=en]").all_inner_texts() == []

    def say_something_new(route: playwright.Route) -> None:
        answer = route.fetch()
        found = {**answer.json(), "verdict": "error", "reason": "the moon is full"}
        route.fulfill(response=answer, json=found)

    page.route("**/api/v1/runs/1", say_something_new)
    to(page, there, "runs/1")
    expect(page.locator(".outcome [lang=en]")).to_have_text("the moon is full")


@IN_GERMAN
def test_the_form_of_a_campaign_is_whole_in_german(page: playwright.Page, there: Served) -> None:
    to(page, there, "campaigns")
    expect(heading(page, "Kampagnen")).to_be_visible()
    expect(page.locator("main").get_by_text("Zweck")).to_be_attached()
    assert page.locator("main [lang=en]").all_inner_texts() == []


@IN_GERMAN
def test_commands_are_found_by_their_names_in_either_language(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches")
    expect(heading(page, "Prüfstände")).to_be_visible()
    for words in ("farben: dunkel", "colours: dark"):
        page.keyboard.press("Control+k")
        page.keyboard.type(words)
        expect(page.get_by_role("dialog").locator("[aria-selected=true]")).to_contain_text("Farben: dunkel")
        page.keyboard.press("Escape")


@pytest.mark.parametrize("locale", ["de", "ja"])
@pytest.mark.parametrize("address", ADDRESSES)
def test_no_view_is_harder_to_use_than_in_english(
    page: playwright.Page, there: Served, locale: str, address: str
) -> None:
    to(page, there, address)
    expect(page.locator("h1").first).to_be_visible()
    expect(page.locator("main").get_by_text(re.compile("Laden:|読み込み中"))).to_have_count(0)
    assert page.locator("html").get_attribute("lang") == locale
    refuse_hard_to_use(page)


def test_a_catalogue_that_does_not_come_leaves_the_page_in_english(
    browser: playwright.Browser, there: Served
) -> None:
    with browser.new_context(locale="de") as context:
        page = context.new_page()
        page.route(re.compile("/assets/de-"), lambda route: route.abort())
        to(page, there, "benches/sim")
        expect(page.get_by_role("button", name="Emergency stop sim")).to_be_visible()
        expect(page.locator("html")).to_have_attribute("lang", "en")


def _elsewhere(text: str) -> str:
    """A moment that is not said in the reader's way; '' if there is none."""
    found = re.search(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d", text)
    return found[0] if found else ""


@pytest.mark.parametrize("locale", ["de", "ja"])
def test_a_stopped_bench_says_so_in_the_readers_words_and_time(
    page: playwright.Page, there: Served, locale: str
) -> None:
    there.post("/benches/sim/emergency-stop")
    there.post("/benches/sim/emergency-stop")
    waiting = there.queue()
    try:
        for address in ("benches/sim", "benches/sim/panel", "benches", f"runs/{waiting}", "wall"):
            to(page, there, address)
            main = page.locator("main")
            expect(main).to_contain_text("Not-Halt seit" if locale == "de" else "から非常停止")
            assert _elsewhere(main.inner_text()) == ""
            expect(main.locator("span[lang=en]")).to_have_count(0)
    finally:
        there.post(f"/runs/{waiting}/abort")
        there.post("/benches/sim/reset")


@pytest.mark.parametrize("locale", ["de"])
@pytest.mark.parametrize("refusals", [("409 (Conflict)",)])
def test_a_refusal_is_in_the_readers_words(page: playwright.Page, there: Served) -> None:
    there.post("/benches/sim/emergency-stop")
    waiting = there.queue()

    def cancel_before(route: playwright.Route) -> None:
        if route.request.method == "PATCH":
            there.post(f"/runs/{waiting}/abort")
        route.continue_()

    try:
        page.route(re.compile(f"/runs/{waiting}$"), cancel_before)
        to(page, there, "benches/sim")
        page.get_by_role("button", name=f"Lauf {waiting} vorziehen").click()
        refusal = page.get_by_role("alert").filter(has_text="Warteschlange")
        expect(refusal).to_have_text(f"Lauf {waiting} ist nicht mehr in der Warteschlange")
    finally:
        there.post("/benches/sim/reset")


@pytest.mark.parametrize("locale", ["de", "ja"])
@pytest.mark.parametrize("refusals", [("422 (Unprocessable",)])
def test_fields_that_are_refused_are_in_the_readers_words(
    page: playwright.Page, there: Served, locale: str
) -> None:
    to(page, there, "runs/1")
    refused = {"what": "must have at most 200 characters", "where": "run 1", "fix": "make it shorter"}
    page.route(re.compile("/runs/1/notes$"), lambda route: _refuse_posts(route, refused))
    note, add = ("Notiz", "Notiz hinzufügen") if locale == "de" else ("メモ", "メモを追加")
    page.get_by_label(note, exact=True).fill("warm")
    page.get_by_role("button", name=add, exact=True).click()
    refusal = page.get_by_role("alert")
    german = "Lauf 1: darf höchstens 200 Zeichen haben\nihn kürzen"
    japanese = "試験 1: 200 文字以内でなければなりません\n短くしてください"
    expect(refusal).to_have_text(german if locale == "de" else japanese)
    expect(refusal.locator("[lang=en]")).to_have_count(0)
    page.get_by_label(note, exact=True).fill("")


def _refuse_posts(route: playwright.Route, refused: dict[str, str]) -> None:
    if route.request.method == "POST":
        route.fulfill(status=422, json=refused)
    else:
        route.continue_()
