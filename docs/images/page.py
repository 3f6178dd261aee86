"""Makes the pictures of the service's page: `make page-picture`, while `make serve` is running."""

from __future__ import annotations

import json
import shutil
import sys
import urllib.request
from collections import defaultdict
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, expect, sync_playwright

HERE = Path(__file__).parent


def main(url: str) -> None:
    """Queue an acceptance run on the first bench and photograph its second segment, then the studios."""
    bench = _get(url, "/benches")[0]["name"]
    body = json.dumps({"plan": "acceptance", "bench": bench}).encode()
    headers = {"content-type": "application/json"}
    urllib.request.urlopen(urllib.request.Request(f"{url}/api/v1/runs", body, headers)).close()
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 1100})
        page.goto(f"{url}/benches/{bench}")
        banner = page.get_by_role("region", name=f"State of {bench}")
        expect(banner).to_contain_text("phase_0kmh", timeout=600_000)
        # the first criteria are decided when its segment is over
        expect(page.locator("tbody .verdict").first).to_be_visible(timeout=600_000)
        page.screenshot(path=HERE / "page.png")
        _photograph_studio(browser, url)
        _photograph_comparison(browser, url)
        browser.close()


def _photograph_studio(browser: Browser, url: str) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 1250})
    page.goto(f"{url}/design?model=three_inertia&d=phase;gain")
    expect(page.locator("thead")).to_contain_text("B notch")
    expect(page.locator("tbody .verdict")).to_have_count(2, timeout=120_000)
    _photograph(page, "design.png")


def _photograph_comparison(browser: Browser, url: str) -> None:
    """Two runs laid over each other if there are two of a plan."""
    plans: dict[str, list[int]] = defaultdict(list)
    for run in _get(url, "/runs?state=ended"):
        plans[run["plan"]].append(run["id"])
    pair = next((runs[:2] for runs in plans.values() if len(runs) > 1), None)
    if pair is None:
        print("comparison.png stays: there are no two runs of a plan that are over")
        return
    page = browser.new_page(viewport={"width": 1280, "height": 1100})
    page.goto(f"{url}/compare?runs={pair[1]},{pair[0]}")
    expect(page.get_by_role("region", name="Criteria", exact=True)).to_be_visible(timeout=120_000)
    _photograph(page, "comparison.png")


def _photograph(page: Page, name: str) -> None:
    page.wait_for_load_state("networkidle")  # what is drawn was asked for before
    page.screenshot(path=HERE / name)


def _get(url: str, path: str) -> Any:
    with urllib.request.urlopen(f"{url}/api/v1{path}") as answer:
        return json.load(answer)


if __name__ == "__main__":
    main(sys.argv[1])
