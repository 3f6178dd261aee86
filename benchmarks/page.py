"""The page in a browser: first useful paint, an hour's recording opened, panned, 10,000 runs filtered.

`python -m benchmarks.page [TURNS]`: a headless Chromium, without a graphics card, on the service with the
runs of `run_list` and the recording of `run_view`. Times count from the address that is opened, or the choice
that is made, to the frame that shows it. Asked: under 1 s, under 1 s, 60 frames/s, under 200 ms.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
from pathlib import Path

from playwright import sync_api as playwright

from benchmarks.run_list import RUNS, fill
from benchmarks.run_view import CHANNELS, SECONDS, record
from tests.hil.service.served import Served, served

TURNS, PAN_S, SHOWN_S = 5, 5.0, 600.0
MOST_PAINT_S, MOST_OPENED_S, MOST_FILTERED_S, LEAST_FRAMES = 1.0, 1.0, 0.2, 60.0
#: Seconds since the page was asked for, once a condition holds and a frame has shown it.
_SINCE_OPENED = """() => new Promise((known) => {
  const look = () => (CONDITION
    ? requestAnimationFrame(() => known(performance.now() / 1000)) : requestAnimationFrame(look));
  look();
})"""
_ROWS = "document.querySelectorAll('tbody tr').length > 0"
#: The first plot has pixels in the first curve's colour.
_CURVES = """(() => {
  const canvas = document.querySelector('figure.plot canvas');
  if (!canvas) return false;
  const hex = getComputedStyle(document.documentElement).getPropertyValue('--series-gain').trim();
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  return new Uint32Array(data.buffer).includes((0xff000000 | (b << 16) | (g << 8) | r) >>> 0);
})()"""
#: Seconds from a choice to the frame that shows what was found.
_FILTERED = """([name, value, found]) => new Promise((known) => {
  const isIt = (one) => one.closest('label').textContent.toLowerCase().startsWith(name);
  const field = [...document.querySelectorAll('.filters select')].find(isIt);
  const began = performance.now();
  field.value = value;
  field.dispatchEvent(new Event('change', { bubbles: true }));
  const look = () => (document.querySelector('main [aria-live]').textContent.includes(found)
    ? requestAnimationFrame(() => known((performance.now() - began) / 1000)) : requestAnimationFrame(look));
  look();
})"""
#: Drags the time axis of the first plot with Shift, a little in each frame: distances of frames, place.
_PANNED = """(seconds) => new Promise((known) => {
  const over = document.querySelector('figure.plot .u-over'), box = over.getBoundingClientRect();
  const y = box.top + 40;
  const shifted = { bubbles: true, shiftKey: true, clientY: y, button: 0 };
  const at = (type, x, to) => to.dispatchEvent(new MouseEvent(type, { ...shifted, clientX: x }));
  let x = box.left + box.width / 2, way = -1, last = 0, began = 0;
  const gaps = [];
  at('mousedown', x, over);
  const step = (now) => {
    began ||= now;
    if (last) gaps.push(now - last);
    last = now;
    if (x < box.left + 20 || x > box.right - 20) way = -way;
    x += 3 * way;
    at('mousemove', x, window);
    if (now - began < 1000 * seconds) requestAnimationFrame(step);
    else { at('mouseup', x, window); known([gaps, location.search]); }
  };
  requestAnimationFrame(step);
})"""


def main(turns: int = TURNS) -> int:
    """Medians of turns, each in a browser without a cache, and which are beyond what is asked."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        recording = folder / "data/runs/000001/recording.mcap"
        recording.parent.mkdir(parents=True)
        record(recording, SECONDS)
        fill(folder / "data/service.sqlite", RUNS)
        with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
            service.get("/runs/1/view")  # its overview is kept beside it, as after every run
            with playwright.sync_playwright() as started:
                browser = started.chromium.launch(
                    executable_path=shutil.which("chromium"), args=["--no-sandbox"]
                )
                return _measured(browser, service, turns)


def _measured(browser: playwright.Browser, service: Served, turns: int) -> int:
    print(f"{turns} turns, Chromium {browser.version}, headless, 1280 x 900, drawn by the processor")
    paint_s = _opened(browser, f"{service.url}/runs", _ROWS, turns)
    print(f"{'first useful paint: list of runs with its rows':52} {_text(paint_s, 's')}")
    opened_s = _opened(browser, f"{service.url}/runs/1", _CURVES, turns)
    print(f"{f'{SECONDS} s of {len(CHANNELS)} channels at 1 kHz, curves shown':52} {_text(opened_s, 's')}")
    page = _page(browser, f"{service.url}/runs", _ROWS)
    page.locator(".filters option", has_text="plan-3").wait_for(state="attached")
    filtered_ms = []
    for _ in range(turns):
        for value, found in (("plan-3", "1,667 runs"), ("", f"{RUNS:,} runs")):
            filtered_ms.append(1e3 * float(page.evaluate(_FILTERED, ["plan", value, found])))
    page.close()
    print(f"{f'{RUNS:,} runs filtered by plan':52} {_text(filtered_ms, 'ms')}")
    page = _page(browser, f"{service.url}/runs/1?t=1200,{1200 + SHOWN_S:g}", _CURVES)
    gaps_ms, search = page.evaluate(_PANNED, PAN_S)
    page.close()
    frames = 1e3 * len(gaps_ms) / sum(gaps_ms)
    late = sum(gap > 25.0 for gap in gaps_ms)
    what = f"panning {SHOWN_S:g} s of it for {PAN_S:g} s"
    print(f"{what:52} {frames:.1f} frames/s, {late} of {len(gaps_ms)} late, at {search}")
    missed = {
        "first useful paint": max(paint_s) > MOST_PAINT_S,
        "an hour opened": max(opened_s) > MOST_OPENED_S,
        "runs filtered": max(filtered_ms) > 1e3 * MOST_FILTERED_S,
        "panning": frames < 0.98 * LEAST_FRAMES,
    }
    print(f"missed by its largest value: {', '.join(one for one in missed if missed[one]) or 'none'}")
    return 0


def _opened(browser: playwright.Browser, url: str, condition: str, turns: int) -> list[float]:
    found = []
    for _ in range(turns):
        with browser.new_context(viewport={"width": 1280, "height": 900}, locale="en-US") as context:
            page = context.new_page()
            page.goto(url, wait_until="commit")
            found.append(float(page.evaluate(_SINCE_OPENED.replace("CONDITION", condition))))
    return found


def _page(browser: playwright.Browser, url: str, condition: str) -> playwright.Page:
    page = browser.new_page(viewport={"width": 1280, "height": 900}, locale="en-US")
    page.goto(url)
    page.evaluate(_SINCE_OPENED.replace("CONDITION", condition))
    return page


def _text(values: list[float], unit: str) -> str:
    digits = 2 if unit == "s" else 0
    return f"median {statistics.median(values):.{digits}f} {unit}, largest {max(values):.{digits}f} {unit}"


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
