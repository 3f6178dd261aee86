"""What every part of the page keeps: nothing that axe finds, nothing cut off, at every width and light.

And every text has its values: no `{name}` stands where a name should.
"""

from __future__ import annotations

import pytest
from playwright import sync_api as playwright

from tests.readers.tools import NotHereError, node_modules

WIDTHS = (1280, 820, 380)
RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]}


def refuse_hard_to_use(page: playwright.Page) -> None:
    """As it is open now; skips the rest of a test where there is no axe."""
    assert raw_placeholders(page) == []
    try:
        axe = node_modules() / "node_modules/axe-core/axe.min.js"
    except NotHereError as missing:
        pytest.skip(str(missing))
    page.evaluate(axe.read_text("utf-8"))
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
            page.evaluate("scrollTo(0, 0)")  # half a control under the bar that stays is small to axe
            found = page.evaluate("rules => axe.run(document, rules)", RULES)["violations"]
            shown = [(one["id"], [node["html"] for node in one["nodes"]]) for one in found]
            assert not shown, f"{shown} at {width} px, {scheme}"


def raw_placeholders(page: playwright.Page) -> list[str]:
    """Texts and attributes that show a placeholder in place of its value; what people wrote is left out."""
    found: list[str] = page.evaluate(_RAW)
    return found


_RAW = """() => {
  const raw = (text) => /\\{\\w+\\}|<\\/?\\w+>/.test(text), found = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let one = texts.nextNode(); one; one = texts.nextNode()) {
    const written = one.parentElement.closest("script, style, textarea, pre, code, .note");
    if (raw(one.data) && !written) found.push(one.data);
  }
  for (const name of ["title", "aria-label", "alt", "placeholder"]) {
    const all = [...document.querySelectorAll(`[${name}]`)].map((one) => one.getAttribute(name));
    found.push(...all.filter(raw).map((value) => `${name}: ${value}`));
  }
  return found;
}"""


def expect_drawn(plot: playwright.Locator, *roles: str) -> None:
    """Waits until a plot's canvas has all of these of the house's colours."""
    playwright.expect(plot.locator("canvas")).to_be_visible()
    plot.page.wait_for_function(_DRAWN, arg=[plot.locator("canvas").element_handle(), list(roles)])


_DRAWN = """([canvas, roles]) => {
  const style = getComputedStyle(document.documentElement);
  const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  const words = new Set(new Uint32Array(data.buffer));
  return roles.every((role) => {
    const hex = (style.getPropertyValue(`--series-${role}`) || style.getPropertyValue(`--${role}`)).trim();
    const [r, g, b] = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
    return words.has((0xff000000 | (b << 16) | (g << 8) | r) >>> 0);
  });
}"""
