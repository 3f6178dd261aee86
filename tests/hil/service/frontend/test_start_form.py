"""Values typed into the form that starts a plan."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, choice, expect, to
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("start")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT)
        yield service


def test_a_decimal_comma_is_kept_on_the_german_page_of_an_english_browser(
    page: playwright.Page, there: Served
) -> None:
    page.add_init_script("localStorage.setItem('language', 'de')")
    to(page, there, "plans/short")
    value = page.get_by_role("textbox", name="torque_nm in N m")
    queue = page.get_by_role("button", name="Lauf einreihen")
    expect(page.locator(".forecast")).to_contain_text("Größtes angefordertes Drehmoment")
    before = queue.bounding_box()
    value.fill("")
    expect(page.locator(".forecast")).to_contain_text("torque_nm in N m: Das Feld ist leer")
    expect(queue).to_be_disabled()
    with page.expect_request(
        lambda asked: asked.url.endswith("/forecasts") and '"torque_nm":20.5' in (asked.post_data or "")
    ):
        value.press_sequentially("20,5")
    expect(page.locator(".forecast")).to_contain_text("Passt", timeout=180_000)
    expect(page.locator(".forecast")).to_contain_text("Größtes angefordertes Drehmoment: 20,5\xa0N\xa0m")
    assert queue.bounding_box() == before
    queue.click()
    expect(page.locator(".facts")).to_contain_text("torque_nm = 20,5")
    there.over(int(page.url.rpartition("/")[2]))


def test_what_is_chosen_and_typed_stands_in_the_address(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches/sim")
    plan, value = choice(page, "Plan"), page.get_by_role("textbox", name="torque_nm in N m")
    plan.select_option("short")
    value.fill("120")
    expect(page).to_have_url(f"{there.url}/benches/sim?plan=short&value.torque_nm=120")
    page.reload()
    expect(plan).to_have_value("short")
    expect(value).to_have_value("120")
    page.get_by_role("link", name="Runs", exact=True).click()
    page.go_back()
    expect(value).to_have_value("120")
    value.fill("100")  # as the plan has it
    expect(page).to_have_url(f"{there.url}/benches/sim?plan=short")
    value.fill("")
    expect(value).to_have_value("")
    plan.select_option("abs_release")
    expect(page).to_have_url(f"{there.url}/benches/sim?plan=abs_release")


def test_values_of_an_address_are_changed_in_it_on_the_page_of_a_plan(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "plans/short?bench=sim&value.torque_nm=150")
    value = page.get_by_role("textbox", name="torque_nm in N m")
    expect(value).to_have_value("150")
    value.fill("20.5")
    expect(page).to_have_url(f"{there.url}/plans/short?bench=sim&value.torque_nm=20.5")


@pytest.mark.parametrize(
    ("address", "said", "link"),
    [
        ("benches/sim?plan=nope", "There is no plan 'nope'", "all plans"),
        ("plans/short?bench=nope", "There is no bench 'nope'", "all benches"),
    ],
)
def test_an_address_with_a_plan_or_a_bench_that_is_not_there_says_so(
    page: playwright.Page, there: Served, address: str, said: str, link: str
) -> None:
    to(page, there, address)
    form = page.locator("form.start")
    expect(form.get_by_role("alert")).to_contain_text(said)
    expect(form.get_by_role("button", name="Queue the run")).to_be_disabled()
    form.get_by_role("link", name=link, exact=True).click()
    expect(page).to_have_url(f"{there.url}/{link.split()[1]}")
