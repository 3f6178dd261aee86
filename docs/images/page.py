"""Makes the pictures of the service's page: `make page-picture`, while `make serve` is running."""

from __future__ import annotations

import json
import shutil
import sys
import urllib.request
from collections import Counter
from pathlib import Path

from playwright.sync_api import Browser, expect, sync_playwright

HERE = Path(__file__).parent


def main(url: str) -> None:
    """Queue an acceptance run on the first bench and photograph its second segment."""
    with urllib.request.urlopen(f"{url}/api/v1/benches") as answer:
        bench = json.load(answer)[0]["name"]
    body = json.dumps({"plan": "acceptance", "bench": bench}).encode()
    headers = {"content-type": "application/json"}
    urllib.request.urlopen(urllib.request.Request(f"{url}/api/v1/runs", body, headers)).close()
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(f"{url}/#{bench}")
        expect(page.locator("#forecast")).to_contain_text("bench time", timeout=120_000)
        expect(page.locator("#why")).to_contain_text("phase_0kmh", timeout=600_000)
        page.wait_for_timeout(15_000)
        page.screenshot(path=HERE / "page.png")
        photograph_parts(browser, url)
        browser.close()


def photograph_parts(browser: Browser, url: str) -> None:
    """The design of a controller, and two runs laid over each other if a bench has two of a plan."""
    page = browser.new_page(viewport={"width": 1280, "height": 1800})
    with urllib.request.urlopen(f"{url}/api/v1/runs?state=ended") as answer:
        ended = Counter((run["bench"], run["plan"]) for run in json.load(answer))
    bench = next((bench for (bench, _), runs in ended.items() if runs > 1), "")
    page.goto(f"{url}/#{bench}")
    page.locator("#design > summary").click()
    page.locator("#design-model").select_option("three_inertia")
    expect(page.locator("#design-figures")).to_contain_text("1.434", timeout=120_000)
    page.wait_for_timeout(1000)
    page.locator("#design").screenshot(path=HERE / "design.png")
    page.locator("#design > summary").click()
    if not bench:
        print("comparison.png stays: no bench has two runs of a plan that are over")
        return
    page.locator("#compare > summary").click()
    expect(page.locator("#compare-found")).to_be_visible(timeout=120_000)
    page.wait_for_timeout(2000)
    page.locator("#compare").screenshot(path=HERE / "comparison.png")


if __name__ == "__main__":
    main(sys.argv[1])
