"""A run is paused and goes on, and is found by any of its words, as a person does both."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, expect, heading, region, to
from tests.hil.service.looks import refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
_STEP = SHORT[SHORT.index("  - step:") : SHORT.index("finally:")]
#: So long that there is time to pause it.
_LONG = SHORT.replace("name: short", "name: long\ntitle: A long plan").replace(
    _STEP,
    _STEP
    + "".join(
        _STEP.replace("segment: s,", f"segment: s{at},").replace("after_s: 1", "after_s: 60")
        for at in range(100)
    ),
)


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("pause")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        service.give("long", _LONG)
        yield service


def test_a_run_is_paused_everywhere_and_goes_on(page: playwright.Page, there: Served) -> None:
    run = there.queue("long")
    to(page, there, f"runs/{run}")
    state = region(page, "State of sim")
    state.get_by_role("button", name="Pause", exact=True).click()
    expect(state).to_contain_text("Paused: A long plan")
    expect(state).to_contain_text(f"Run {run}, by local: paused by the operator")
    expect(state).to_contain_text("The run is paused and the torque is off.")
    expect(state.get_by_role("button", name="Pause", exact=True)).to_have_count(0)
    refuse_hard_to_use(page)
    for address in ("benches/sim", "benches/sim/panel"):
        to(page, there, address)
        expect(heading(page, "Paused")).to_be_visible()
    for address in ("benches", "wall"):
        to(page, there, address)
        expect(page.get_by_role("listitem").filter(has_text="sim").locator(".state")).to_have_text("Paused")
    assert there.get(f"/runs/{run}")["doing"].startswith("held")
    to(page, there, "benches/sim/panel")
    page.get_by_role("button", name="Resume").click()
    expect(heading(page, "Running")).to_be_visible()
    page.get_by_role("button", name="End the run", exact=True).click()
    assert there.over(run)["reason"] == "stopped by the operator"
    to(page, there, f"runs/{run}")
    events = region(page, "Segments and events")
    expect(events).to_contain_text("paused, torque off, the dynos hold their speed: paused by the operator")
    expect(events).to_contain_text("resumes after")


@pytest.mark.parametrize(
    "words",
    ["plan short 100", "100 short", "local short", "sim-0001 pass", "belt short", "run {run}", "#{run}"],
)
def test_a_run_is_found_by_all_of_its_words_in_any_order(
    page: playwright.Page, there: Served, words: str
) -> None:
    ended = [one["id"] for one in there.get("/runs") if one["plan"] == "short"]
    run = ended[0] if ended else there.over(there.queue(values={"torque_nm": 100}))["id"]
    there.ask("PUT", f"/api/v1/runs/{run}/tags/belt-7")
    to(page, there, "benches")
    page.get_by_role("button", name="Find").click()
    page.keyboard.type(words.format(run=run))
    offered = page.get_by_role("dialog").get_by_role("option")
    expect(offered.filter(has_text=f"Run {run}")).to_contain_text(
        "A short plan (short, torque_nm = 100), sim, pass"
    )
    offered.filter(has_text=f"Run {run}").click()
    expect(page.get_by_text(f"Run {run} on sim")).to_be_visible()


def test_words_that_nothing_has_say_so(page: playwright.Page, there: Served) -> None:
    to(page, there, "benches")
    expect(heading(page, "Benches")).to_be_visible()
    page.keyboard.press("Control+k")
    for words in ("short tomorrow", "run 99999", "run 20261128123718"):
        page.get_by_role("combobox").fill(words)
        expect(page.get_by_role("dialog").get_by_text("Nothing has these words.")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
