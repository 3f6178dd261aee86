"""The page in Firefox: every address shows its view, and axe finds nothing."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.hil.service.frontend.browsed import BUILT
from tests.hil.service.frontend.firefox import FIREFOX, Firefox, firefox
from tests.hil.service.frontend.test_languages import ADDRESSES
from tests.hil.service.looks import RULES
from tests.hil.service.served import SHORT, Served, served
from tests.readers.tools import NotHereError, node_modules

pytestmark = [pytest.mark.slow, BUILT, pytest.mark.skipif(FIREFOX is None, reason="there is no Firefox")]
_LOADED = """
  const main = document.querySelector("main"), title = document.querySelector("h1");
  return title && main && !/Loading|Laden:|読み込み中/.test(main.innerText) ? title.innerText : "";
"""
_STOPS = 120  # of Tab, after which a person would have given up long ago
_AXE = """
  const { violations } = await axe.run(document, arguments[0]);
  return violations.map((one) => `${one.id}: ${one.nodes.map((node) => node.html).join(" ")}`);
"""
_TROUBLES = """
  window.troubles = window.troubles ?? [];
  addEventListener("error", (event) => troubles.push(event.message));
  addEventListener("unhandledrejection", (event) => troubles.push(String(event.reason)));
"""


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with two runs that ended."""
    folder = tmp_path_factory.mktemp("firefox")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        service.give("short", SHORT.replace("name: short", "name: short\ntitle: A short plan"))
        for torque_nm in (100, 150):
            service.over(service.queue(values={"torque_nm": torque_nm}))
        yield service


@pytest.fixture(scope="module", params=["en", "de", "ja"])
def window(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    """Firefox that prefers a language; dark in German."""
    language = str(request.param)
    with firefox(tmp_path_factory.mktemp("profile"), language=language, dark=language == "de") as found:
        found.resize(1000, 900)
        yield found


@pytest.mark.parametrize("address", ADDRESSES)
def test_each_address_shows_its_view_and_is_easy_to_use(
    window: Firefox, there: Served, address: str, request: pytest.FixtureRequest
) -> None:
    try:
        axe = node_modules() / "node_modules/axe-core/axe.min.js"
    except NotHereError as missing:
        pytest.skip(str(missing))
    window.open(f"{there.url}/{address}")
    assert window.until(_LOADED)
    assert window.run("return document.documentElement.lang") == request.node.callspec.params["window"]
    window.run(axe.read_text("utf-8"))
    assert window.run(_AXE, RULES) == []
    assert window.run("return document.documentElement.scrollWidth <= innerWidth")


def test_a_plan_is_queued_from_its_form(window: Firefox, there: Served) -> None:
    window.open(f"{there.url}/plans/short")
    window.run(_TROUBLES)
    window.until("return document.querySelector('form.start button.main:enabled')")
    window.run("document.querySelector('form.start button.main').click()")
    run = int(window.until("return location.pathname.startsWith('/runs/') && location.pathname.slice(6)"))
    there.over(run)
    assert window.until("return document.querySelectorAll('.plots canvas').length >= 4")
    assert window.run("return troubles") == []


def test_a_run_goes_from_start_to_result_by_keyboard_alone(window: Firefox, there: Served) -> None:
    window.open(f"{there.url}/benches")
    window.until(_LOADED)
    window.press("k", held="Control")
    window.until("return document.querySelector('dialog.palette')?.contains(document.activeElement)")
    window.press(*"short")
    window.until("return /short/.test(document.querySelector('dialog [aria-selected=true]')?.innerText)")
    window.press("Enter")
    window.until("return location.pathname === '/plans/short'")
    window.until("return document.querySelector('form.start button.main:enabled')")
    _go_to(window, "document.activeElement.matches('form.start button.main')")
    window.press("Enter")
    run = int(window.until("return location.pathname.startsWith('/runs/') && location.pathname.slice(6)"))
    assert there.over(run)["verdict"] == "pass"
    window.until("return document.querySelector('main a[href$=\"report.html\"]')")
    _go_to(window, "document.activeElement.matches('main a[href$=\"report.html\"]')")


def _go_to(window: Firefox, there: str) -> None:
    """Press Tab until the focus is somewhere, which shows: a person sees where it is."""
    for _ in range(_STOPS):
        if window.run(f"return {there}"):
            assert window.run("return getComputedStyle(document.activeElement).outlineStyle") != "none"
            return
        window.press("Tab")
    raise AssertionError(f"no Tab leads to where {there}")
