"""Figures of benchmarks stand in pages as commands printed them, each with its commit."""

from __future__ import annotations

import importlib.util
import re

import pytest

from benchmarks.pages import PAGES, ROOT, blocks, heading, with_figures

PAGE = "before\n<!-- figures: plant -->\nold\n<!-- end of figures -->\nafter\n"


@pytest.mark.parametrize("part", PAGES)
def test_each_part_has_its_block_with_command_date_and_commit(part: str) -> None:
    assert importlib.util.find_spec(f"benchmarks.{part}") is not None
    text = blocks((ROOT / PAGES[part]).read_text("utf-8"))[part]
    assert re.match(rf"`python -m benchmarks\.{part}`, \d{{4}}-\d\d-\d\d, commit [0-9a-f]{{7,}}\+?, ", text)


def test_pages_have_blocks_of_known_parts_only() -> None:
    for page in set(PAGES.values()):
        found = blocks((ROOT / page).read_text("utf-8"))
        assert set(found) == {part for part, of in PAGES.items() if of == page}


def test_a_block_is_written_and_the_rest_stays() -> None:
    changed = with_figures(PAGE, "plant", heading("plant"), "kernel  1.00  \nC  1.00\n")
    assert changed.startswith("before\n<!-- figures: plant -->\n`python -m benchmarks.plant`, ")
    assert changed.endswith("\n```text\nkernel  1.00\nC  1.00\n```\n<!-- end of figures -->\nafter\n")


def test_a_page_without_the_block_is_refused() -> None:
    with pytest.raises(ValueError, match="no block '<!-- figures: check -->'"):
        with_figures(PAGE, "check", "first", "text")
