"""Figures of benchmarks in the documentation: each block is what a command printed, with its commit.

A page marks a block with `<!-- figures: PART -->` and `<!-- end of figures -->`; whatever stands between them
is written by `python -m benchmarks --write PART` and by no one else.
"""

from __future__ import annotations

import datetime
import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[1]
_BENCHMARKS, _SPEED = "benchmarks/README.md", "docs/reference/speed.md"
#: Part, a module of this package that prints: the page that holds its figures.
PAGES = {
    "commands": _SPEED,
    "replay": _SPEED,
    "plant": _BENCHMARKS,
    "many_models": _BENCHMARKS,
    "virtual_time": _BENCHMARKS,
    "check": _BENCHMARKS,
    "reports": _BENCHMARKS,
    "identification": _BENCHMARKS,
    "transports": _BENCHMARKS,
    "recorder": _BENCHMARKS,
    "second_process": _BENCHMARKS,
    "run_list": _BENCHMARKS,
    "run_view": _BENCHMARKS,
    "page": _BENCHMARKS,
}
_BLOCK = re.compile(r"<!-- figures: (?P<part>\w+) -->\n(?P<text>.*?)<!-- end of figures -->", re.DOTALL)


def blocks(page: str) -> dict[str, str]:
    """What stands between the marks of each part of a page."""
    return {found["part"]: found["text"] for found in _BLOCK.finditer(page)}


def heading(part: str) -> str:
    """What is printed by which command, when, of which commit, and beside what load, before it is run."""
    load = f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors"
    return f"`python -m benchmarks.{part}`, {_today()}, commit {commit()}, {load}:"


def with_figures(page: str, part: str, first: str, printed: str) -> str:
    """The page with the block of a part written anew; the rest stays as it is.

    Raises:
        ValueError: the page has no such block.
    """
    if part not in blocks(page):
        raise ValueError(f"the page has no block '<!-- figures: {part} -->'")
    lines = "\n".join(line.rstrip() for line in printed.strip("\n").splitlines())
    block = f"<!-- figures: {part} -->\n{first}\n\n```text\n{lines}\n```\n<!-- end of figures -->"
    return _BLOCK.sub(lambda found: block if found["part"] == part else found[0], page)


def commit() -> str:
    """The commit of the code that runs, with a + where the code differs from it."""
    changed = _git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs", ":!*.md")
    return (_git("rev-parse", "--short", "HEAD") or "unknown") + ("+" if changed else "")


def _git(*arguments: str) -> str:
    done = subprocess.run(("git", *arguments), cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip()


def _today() -> str:
    return f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}"
