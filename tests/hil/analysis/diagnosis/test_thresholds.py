"""Every threshold is told once, with unit, meaning and a check that exists."""

import re
from pathlib import Path

from hil.analysis.diagnosis.thresholds import CHECKS, page, thresholds

_ROOT = Path(__file__).parents[4]


def test_the_page_is_what_stands_in_the_module() -> None:
    assert (_ROOT / "docs/reference/thresholds.md").read_text(encoding="utf-8") == page()


def test_every_check_of_a_threshold_exists() -> None:
    assert {one.checked_by for one in thresholds()} == set(CHECKS)
    files = [_ROOT / file for command in CHECKS.values() for file in command.split()[3:]]
    assert [file for file in files if not file.is_file()] == []


def test_every_threshold_is_told() -> None:
    text = (_ROOT / "hil/analysis/diagnosis/thresholds.py").read_text(encoding="utf-8")
    assert [one.name for one in thresholds()] == re.findall(r"^([A-Z_]+) = [\d(]", text, re.MULTILINE)


def test_no_number_is_named_anywhere_else() -> None:
    numbers = re.compile(r"^_?[A-Z][A-Z_]* = \(?-?[\d.]", re.MULTILINE)
    allowed = {
        "STARTS",
        "_GRID",
        "_RPM",
        "_GEAR",
        "_EDGES_HZ",
        "_STEP",
        "_REQUEST",
        "_DT",
    }  # counts, units and grids: nothing is decided by them
    places = [p for p in (_ROOT / "hil/analysis/diagnosis").rglob("*.py") if p.stem != "thresholds"]
    named = [m[0].split(" ")[0] for p in places for m in numbers.finditer(p.read_text(encoding="utf-8"))]
    assert set(named) <= allowed
