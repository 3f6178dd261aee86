"""The gate and the night: what the gate names exists, every slow test runs in one, the page agrees."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.gate import GATE, gates
from tests.nightly import PAGE, PARTS, counted, with_row

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("place", GATE)
def test_what_gates_is_there(place: str) -> None:
    module, _, name = place.partition("::")
    text = (ROOT / "tests" / module).read_text("utf-8")
    assert "slow" in text
    assert name in text
    assert gates(f"tests/{module}::test_{name}")


def test_what_is_not_named_does_not_gate() -> None:
    assert not gates("tests/hil/service/test_api_fuzz.py::test_a_call[1]")
    assert not gates("tests/hil/cli/test_tune.py::test_ctrl_c_keeps_the_best_so_far")


def test_every_slow_test_runs_in_a_part_of_the_night_or_in_the_gate() -> None:
    places = [place for part in PARTS.values() if part.mark == "nightly" for place in part.places]
    slow = [
        str(file.relative_to(ROOT))
        for file in (ROOT / "tests").rglob("test_*.py")
        if "mark.slow" in file.read_text("utf-8") and file.name != Path(__file__).name
    ]
    places += [f"tests/{place}" for place in GATE if "::" not in place]  # all of these gate
    left_out = [file for file in slow if not any(file.startswith(place) for place in places)]
    assert slow
    assert left_out == []


def test_the_places_of_parts_exist() -> None:
    places = [place.removeprefix("--ignore=") for part in PARTS.values() for place in part.places]
    assert [place for place in places if not (ROOT / place).exists()] == []


def test_the_page_has_every_module_and_part() -> None:
    page = PAGE.read_text("utf-8")
    assert [place for place in GATE if f"| `tests/{place}` | {GATE[place]} |" not in page] == []
    assert [name for name, part in PARTS.items() if f"| `{name}` | {part.proves} |" not in page] == []


def test_a_part_that_ended_writes_its_row_and_no_other() -> None:
    page = PAGE.read_text("utf-8")
    changed = with_row(page, "fuzz", ["2026-01-02", "abc1234", "12", "19 passed"])
    (row,) = set(changed.splitlines()) - set(page.splitlines())
    assert row == f"| `fuzz` | {PARTS['fuzz'].proves} | 2026-01-02 | abc1234 | 12 | 19 passed |"


def test_failures_are_counted_from_the_file_that_pytest_writes(tmp_path: Path) -> None:
    file = tmp_path / "junit.xml"
    file.write_text(
        '<testsuites><testsuite name="pytest" errors="1" failures="2" skipped="3" tests="10"/></testsuites>'
    )
    assert counted(file) == "4 passed, 2 failed, 1 with errors, 3 skipped"
