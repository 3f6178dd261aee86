"""No view scrolls sideways, whatever people call things: names of 64 letters, notes of one word."""

from __future__ import annotations

import datetime
import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, to
from tests.hil.service.served import ASKING, SHORT, Served, served

pytestmark = IN_A_BROWSER
_BENCHES = Path(__file__).parents[4] / "benches"
_CONTROLLERS = Path(__file__).parents[4] / "test_plans/library/controllers"
WIDTHS = (1280, 820, 390)
WORD = "W" * 64
SENTENCE_OF_ONE_WORD = "Wheelspeedobservertimeconstant" * 6
ADDRESSES = (
    "benches",
    f"benches/{WORD}",
    f"benches/{WORD}/panel",
    "wall",
    f"wall/{WORD}",
    "runs",
    f"runs?plan={WORD}&text={WORD}",
    "runs/1",
    "runs/2",
    "runs/3",
    "compare?runs=1,2",
    f"trends?bench={WORD}&plan={WORD}",
    "plans",
    "plans?write=new",
    f"plans/{WORD}",
    f"plans/{WORD}?write=on",
    f"models/{WORD}",
    f"controllers/{WORD}",
    f"controllers/{WORD}?write=on",
    "bench-files",
    "design",
    "identifications",
    "diagnoses",
    "tunings",
    "campaigns",
    "recordings",
    "audit",
    "settings",
    f"plans/{WORD}x",
    WORD,
)
_WIDEST = """width => {
  if (document.documentElement.scrollWidth <= width) return null;
  const all = [...document.querySelectorAll("body *")];
  const outside = (one) => one.getBoundingClientRect().right > width + 1;
  const wide = all.filter((one) => outside(one) && !one.closest(".scroll, pre, .editor"));
  return wide.slice(0, 4).map(one => `${one.tagName}.${one.className}: ${one.textContent.slice(0, 40)}`);
}"""


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A bench, plans, a model, a controller of long names; runs 1 and 2 ended, 3 asks, 4 waits."""
    folder = tmp_path_factory.mktemp("long")
    shutil.copytree(_BENCHES, folder / "benches")
    sim = (_BENCHES / "sim.toml").read_text("utf-8")
    own = sim.replace('name = "sim"', f'name = "{WORD}"').replace('"sim/', f'"{WORD}/')
    own = own.replace("Simulated rear axle bench", SENTENCE_OF_ONE_WORD)
    (folder / "benches/own.toml").write_text(own, "utf-8")
    arguments = ("--bench", str(folder / "benches/own.toml"), "--rate", "1000")
    with served(folder / "data", *arguments, state=folder / "state") as service:
        _fill(service)
        yield service


def _fill(service: Served) -> None:
    title = f"name: {WORD}\ntitle: {SENTENCE_OF_ONE_WORD}\ndescription: {SENTENCE_OF_ONE_WORD}"
    service.give(WORD, SHORT.replace("name: short", title).replace("segment: s,", f"segment: {WORD},"))
    asked = ASKING.replace("name: asking", f"name: asking\ntitle: {SENTENCE_OF_ONE_WORD}")
    service.give("asking", asked.replace("Is the cage shut?", SENTENCE_OF_ONE_WORD))
    model = (_BENCHES / "three_inertia.toml").read_text("utf-8")
    service.ask("PUT", f"/api/v1/models/{WORD}", model)
    controller = (_CONTROLLERS / "phase_stabilization.toml").read_text("utf-8")
    service.ask("PUT", f"/api/v1/controllers/{WORD}", controller)
    for _ in range(2):
        service.over(service.queue(WORD, WORD))
    service.post("/runs/1/notes", {"text": SENTENCE_OF_ONE_WORD})
    service.ask("PUT", f"/api/v1/runs/1/tags/{'w' * 40}")
    service.post(
        f"/benches/{WORD}/handovers",
        {"day": datetime.date.today().isoformat(), "shift": "early", "text": SENTENCE_OF_ONE_WORD},
    )
    now = datetime.datetime.now(datetime.UTC)
    span = {"begins": now + datetime.timedelta(hours=1), "ends": now + datetime.timedelta(hours=2)}
    times = json.loads(json.dumps(span, default=datetime.datetime.isoformat))
    service.post(f"/benches/{WORD}/reservations", {**times, "reason": SENTENCE_OF_ONE_WORD})
    service.until(service.queue("asking", WORD), lambda run: run["prompt"] is not None)
    service.queue(WORD, WORD)


@pytest.fixture
def refusals() -> tuple[str, ...]:
    return ("401 (Unauthorized)", "404 (Not Found)", "422 (Unprocessable")


@pytest.mark.parametrize("locale", ["en-US", "de", "ja"])
def test_no_view_scrolls_sideways_however_long_the_words(page: playwright.Page, there: Served) -> None:
    found = []
    for address in ADDRESSES:
        to(page, there, address)
        expect(page.locator("h1").first).to_be_visible()
        expect(page.locator(".top, .wall .state").first).to_be_visible()
        loading = page.locator("main").get_by_text(re.compile("Loading|Laden:|読み込み中"))
        expect(loading).to_have_count(0)
        for width in WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            if wide := page.evaluate(_WIDEST, width):
                found.append((address[:40], width, wide))
    assert found == []


@pytest.mark.parametrize("locale", ["en-US", "de", "ja"])
def test_the_forecast_beside_a_bench_shows_every_column_at_a_width_of_1280(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, f"benches/{WORD}?plan=acceptance")
    table = page.locator(".forecast .scroll")
    expect(table.locator("tbody tr").first).to_be_visible(timeout=240_000)
    assert table.evaluate("one => one.scrollWidth - one.clientWidth") <= 0


def test_a_table_that_is_wider_than_its_place_shows_that_more_is_there(
    page: playwright.Page, there: Served
) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    to(page, there, "runs")
    table = page.locator(".scroll").first
    expect(table.locator("tbody tr").first).to_be_visible()
    assert table.evaluate("one => one.scrollWidth > one.clientWidth")
    assert "local" in table.evaluate("one => getComputedStyle(one).backgroundAttachment")
    to(page, there, "audit")
    page.set_viewport_size({"width": 1280, "height": 844})
    expect(table.locator("tbody tr").first).to_be_visible()
    assert table.evaluate("one => one.scrollWidth - one.clientWidth") <= 0


def test_the_editors_forecast_shows_every_column_at_a_width_of_1280(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "plans/acceptance?write=on")
    table = page.get_by_role("region", name="Criteria, table")
    expect(table.get_by_role("columnheader", name="verdict")).to_be_visible(timeout=240_000)
    for hidden in table.evaluate_all("all => all.map(one => one.scrollWidth - one.clientWidth)"):
        assert hidden <= 0
