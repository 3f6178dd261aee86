"""Every threshold is told once, with unit, meaning and a check that exists."""

import re
from pathlib import Path

from hil.analysis.diagnosis.thresholds import CHECKS, page, thresholds

_ROOT = Path(__file__).parents[4]


def test_the_page_is_what_stands_in_the_module() -> None:
    assert (_ROOT / "docs/reference/thresholds.md").read_text(encoding="utf-8") == page()


def test_every_check_of_a_threshold_exists() -> None:
    told = {means.checked_by for _, _, means in thresholds()}
    assert told == set(CHECKS)
    files = [command.split()[-1] for command in CHECKS.values() if command.endswith(".py")]
    assert [f for f in files if not (_ROOT / f).is_file()] == []


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
    places = (_ROOT / "hil/analysis/diagnosis").rglob("*.py")
    named = [m[0].split(" ")[0] for p in places for m in numbers.finditer(p.read_text(encoding="utf-8"))]
    assert set(named) <= allowed
