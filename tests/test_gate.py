"""The gate and the night: what the gate names exists, every slow test runs in one, the page agrees."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests import gate
from tests.durations import Stopwatch
from tests.gate import MODULE_S, PINNED, QUICK_S, gating, is_long
from tests.nightly import PAGE, PARTS, counted, with_row

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("place", PINNED)
def test_what_is_pinned_is_there(place: str) -> None:
    module, _, name = place.partition("::")
    assert name.partition("[")[0] in (ROOT / "tests" / module).read_text("utf-8")


def test_what_is_measured_is_there() -> None:
    modules = {ROOT / nodeid.partition("::")[0] for nodeid in gate.measured()}
    assert [module for module in modules if module.suffix == ".py" and not module.exists()] == []


def test_of_a_module_the_shortest_gate_that_fit_and_what_is_pinned(monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = {"m.py::a": 5.0, "m.py::b": 0.9, "m.py::c": 4.0, "m.py": 2.0, "n.py::d": 90.0}
    monkeypatch.setattr(gate, "measured", lambda: seconds)
    monkeypatch.setattr(gate, "MODULE_S", 8.0)
    assert gating(["m.py::a", "m.py::b", "m.py::c", "m.py::never", "n.py::d"]) == {"m.py::b", "m.py::c"}
    killed = "tests/hil/cli/test_kills.py::test_a_run_that_is_killed_leaves_no_torque"
    assert gating([killed]) == {killed}


def test_what_is_prepared_counts_for_tests_that_use_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gate, "measured", lambda: {"m.py": 2 * QUICK_S})
    assert (is_long("m.py::a", prepared=True), is_long("m.py::a", prepared=False)) == (True, False)


def test_seconds_of_what_was_not_carried_out_stay(tmp_path: Path) -> None:
    file = tmp_path / "durations.json"
    file.write_text('{"m.py::gone": 3.0, "m.py": 9.0, "n.py::kept": 4.0}')
    watch = Stopwatch()
    watch.prepared_s = {"m.py::first": 6.0, "m.py::second": 0.0}
    watch.took_s = {"m.py::first": 0.1, "m.py::second": MODULE_S, "m.py::marked": 0.2}
    watch.marked = {"m.py::marked"}
    watch.written_to(file)
    assert json.loads(file.read_text()) == {
        "m.py": 6.0, "m.py::gone": 3.0, "m.py::marked": 0.2, "m.py::second": MODULE_S, "n.py::kept": 4.0
    }  # fmt: skip


def test_every_test_that_may_be_slow_is_below_a_part_of_the_night() -> None:
    places = [place for part in PARTS.values() if part.mark == "nightly" for place in part.places]
    folders = [place for place in places if not place.startswith("--")]
    files = [str(file.relative_to(ROOT)) for file in (ROOT / "tests").rglob("test_*.py")]
    left_out = [file for file in files if not any(file.startswith(place) for place in folders)]
    slow = [nodeid for nodeid in gate.measured() if nodeid.partition("::")[0] in left_out]
    assert [nodeid for nodeid in slow if not gate.pinned(nodeid)] == []
    assert {Path(file).parts[1] for file in left_out} == {"can_vm", "test_gate.py", "test_words.py"}


def test_the_places_of_parts_exist() -> None:
    places = [place.removeprefix("--ignore=") for part in PARTS.values() for place in part.places]
    assert [place for place in places if not (ROOT / place).exists()] == []


def test_the_page_has_every_pin_and_part() -> None:
    page = PAGE.read_text("utf-8")
    assert [place for place in PINNED if f"| `tests/{place}` | {PINNED[place]} |" not in page] == []
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
