"""The page where benches come and go with their agents."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, expect, heading, to
from tests.hil.service.served import ASKING, Served, served
from tests.hil.service.working import bench_called, working

pytestmark = IN_A_BROWSER


@pytest.fixture
def there(tmp_path: Path) -> Iterator[Served]:
    with served(tmp_path / "data", "--no-bench", state=tmp_path / "state") as one:
        one.give("asking", ASKING)
        yield one


def test_the_page_tells_where_a_bench_is_and_that_its_agent_is_away(
    there: Served, page: playwright.Page, tmp_path: Path
) -> None:
    to(page, there, "")
    expect(page.get_by_text("No bench yet.")).to_be_visible()
    bench = bench_called("cell-3", tmp_path / "benches")
    with working(
        there.url, tmp_path / "agent", bench, state=tmp_path / "far", arguments=("--name", "anna's")
    ) as agent:
        page.get_by_role("link", name="cell-3", exact=True).click()
        expect(heading(page, "Free")).to_be_visible()
        expect(page.get_by_role("region", name="State of cell-3")).to_contain_text(", at ")
        there.queue("asking", bench="cell-3")
        expect(page.get_by_text("Is the cage shut?")).to_be_visible()
        expect(page.get_by_role("button", name="Continue", exact=True)).to_be_visible()
        agent.kill()
    expect(heading(page, "Agent not connected")).to_be_visible()
    expect(page.get_by_text("its agent anna's on")).to_be_visible()
    expect(page.get_by_role("button", name="Continue", exact=True)).to_be_hidden()
    page.get_by_role("button", name="Emergency stop cell-3").click()
    expect(heading(page, "Emergency stop asked for, NOT CONFIRMED")).to_be_visible()
    page.get_by_role("button", name="Release from its agent").click()
    answer(page, "Release from its agent")
    expect(page.get_by_role("cell", name="interrupted")).to_be_visible()
