"""Words that were no one's have left the names of modules and classes, and do not come back (glossary.md)."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("hil", "drivers", "test_plans", "reports", "sim_backend")
#: Each with the field's word in its place.
LEFT = {
    "desk": "worker pool",
    "shelf": "catalogue",
    "shelves": "catalogues",
    "giving": "upload reader",
    "arrivals": "run upload, arrival times",
    "carried": "run execution",
    "said": "broadcast cache",
    "numbered": "job repository",
    "showing": "live hub",
    "border": "IPC",
    "watchkeeping": "run monitoring",
    "warming": "JIT warm-up",
    "playing": "waveform player",
    "patience": "retry",
    "belonging": "report identity",
    "crowd": "connection limit",
}
_FILES = [file for package in PACKAGES for file in sorted((ROOT / package).rglob("*.py"))]


def words_of(name: str) -> set[str]:
    """The words of a name in snake or camel case."""
    return {word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name)}


@pytest.mark.parametrize("package", PACKAGES)
def test_no_module_has_a_word_that_left(package: str) -> None:
    names = {part for file in (ROOT / package).rglob("*.py") for part in (*file.parts[:-1], file.stem)}
    assert {name for name in names if words_of(name) & LEFT.keys()} == set()


def test_no_class_has_a_word_that_left() -> None:
    classes = {
        node.name
        for file in _FILES
        for node in ast.walk(ast.parse(file.read_text("utf-8")))
        if isinstance(node, ast.ClassDef)
    }
    found = {name for name in classes if words_of(name) & LEFT.keys()}
    assert found == set()
