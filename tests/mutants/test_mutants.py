"""Which faults are drawn, how they are told from the code as it was, and the score's interval."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.mutants.again import not_noticed_before
from tests.mutants.covering import Coverage, shown_by
from tests.mutants.mutating import drawn
from tests.mutants.page import Outcome, Tried, as_markdown, wilson
from tests.mutants.run import explained
from tests.mutants.trying import Trial

SOURCE = '''
from numba import njit


class Limits:
    largest: float | int = 3


def clipped(value: float | None, *, low: int = 1) -> float | None:
    """Docstring 7."""
    if value is None or value < low:
        return low
    return value + 0.5


@njit(cache=True)
def fast(value):
    return value * 2
'''


HEAD = "def clipped(value: float | None, *, low: int = 1) -> float | None:"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / "code.py").write_text(SOURCE)
    return tmp_path


def test_every_place_is_drawn_once_before_any_a_second_time(root: Path) -> None:
    mutants, total = drawn([root / "code.py"], root, 1000, 1)
    places = [(m.line, m.column) for m in mutants]
    first = places[: len(set(places))]
    assert len(first) == len(set(first))
    assert len(mutants) <= total
    assert mutants == drawn([root / "code.py"], root, 1000, 1)[0]
    assert mutants != drawn([root / "code.py"], root, 1000, 2)[0]


def test_annotations_and_compiled_functions_are_left_alone_and_all_else_is_changed(root: Path) -> None:
    mutants, _ = drawn([root / "code.py"], root, 1000, 1)
    changed = {m.code(SOURCE) for m in mutants}
    assert len(changed) == len(mutants)
    assert SOURCE not in changed
    for code in changed:
        assert "float | int" in code
        assert "float | None" in code
        assert "value * 2" in code
    assert any("low: int = 2" in code for code in changed)
    assert any("largest: float | int = 4" in code for code in changed)
    assert any("and value < low" in code for code in changed)


def test_the_quickest_tests_of_a_line_come_first_and_a_line_of_imports_has_its_files_tests() -> None:
    coverage = Coverage({"code.py": {5: {"slow", "quick"}}}, {"code.py": {"slow", "quick", "other"}}, {
        "slow": 2.0, "quick": 0.1, "other": 1.0,
    })  # fmt: skip
    assert coverage.tests_for("code.py", [5]) == ["quick", "slow"]
    assert coverage.tests_for("code.py", [1]) == ["quick", "other", "slow"]
    assert coverage.tests_for("elsewhere.py", [1]) == []


def test_tests_named_after_the_file_come_before_quicker_ones_unless_they_take_long() -> None:
    seconds = {"tests/test_code.py::one": 0.5, "tests/test_code.py::two": 5.0, "a": 0.1, "b": 2.0}
    coverage = Coverage({"code.py": {5: set(seconds)}}, {}, seconds)
    named = [f"tests/test_code.py::{name}" for name in ("one", "two")]
    assert coverage.tests_for("code.py", [5]) == [named[0], "a", named[1], "b"]


def test_a_file_that_only_other_processes_run_has_the_tests_named_after_it() -> None:
    seconds = {"tests/test_worker.py::test_it": 1.0, "tests/test_workers.py::test_them": 1.0}
    assert Coverage({}, {}, seconds).tests_for("hil/_worker.py", [3]) == ["tests/test_worker.py::test_it"]


def test_lines_of_importing_have_the_tests_of_the_files_folder_too() -> None:
    seconds = {"tests/hil/test_limits.py::test_them": 1.0, "tests/hil/core/test_limits.py::test_them": 1.0}
    coverage = Coverage({"hil/code.py": {5: {"elsewhere"}}}, {}, seconds | {"elsewhere": 1.0})
    assert coverage.tests_for("hil/code.py", [3]) == ["tests/hil/test_limits.py::test_them"]
    assert coverage.tests_for("hil/code.py", [5]) == ["elsewhere"]


def test_a_functions_head_is_shown_by_its_body() -> None:
    lines = SOURCE.splitlines()
    head, decorator = (lines.index(text) + 1 for text in (HEAD, "@njit(cache=True)"))
    assert lines[shown_by(SOURCE, head)[0] - 1].strip() == '"""Docstring 7."""'
    assert [lines[n - 1].strip() for n in shown_by(SOURCE, decorator)] == ["return value * 2"]
    assert list(shown_by(SOURCE, 6)) == [6]


def test_the_interval_is_wilsons() -> None:
    # Wilson's interval solves |share - p| = z sqrt(p (1 - p) / n)
    for successes, trials in ((0, 10), (7, 10), (285, 300), (300, 300)):
        share = successes / trials
        for end in wilson(successes, trials):
            assert abs(share - end) == pytest.approx(1.96 * (end * (1 - end) / trials) ** 0.5, abs=1e-7)


def test_the_page_shows_what_was_not_noticed() -> None:
    outcomes = [
        Outcome("a.py", 3, "AddNot", "if x | y:", "if not x | y:", "", 4),
        Outcome("a.py", 9, "NumberReplacer", "x = 1", "x = 2", "not run", 0),
        Outcome("a.py", 5, "NumberReplacer", "y = 1", "y = 2", "failed", 1),
        Outcome("a.py", 6, "NumberReplacer", "u = 1", "u = 2", "timeout", 1),
    ]
    page = as_markdown([Tried("hil.core", 1, 50, 20, 1.5, outcomes)], {})
    assert "| hil.core | 4 | 50 | 2 | 1 | 50.0 |" in page
    assert "| a.py:3 | `if x \\| y:` | `if not x \\| y:` | passed |" in page
    assert "| a.py:9 | `x = 1` | `x = 2` | not run |" in page
    assert "y = 2" not in page


def test_the_page_says_why_what_was_read_stays() -> None:
    outcomes = [
        Outcome("a.py", 3, "NumberReplacer", "x = 1", "x = 2", "", 4),
        Outcome("a.py", 9, "NumberReplacer", "z = 1", "z = 2", "", 4),
    ]
    page = as_markdown(
        [Tried("hil.core", 1, 50, 20, 1.5, outcomes)], {("a.py", "x = 1", "x = 2"): "only words"}
    )
    assert "| a.py:3 | `x = 1` | `x = 2` | passed | only words |" in page
    assert "| a.py:9 | `z = 1` | `z = 2` | passed |  |" in page


def test_what_was_not_noticed_is_found_again_wherever_it_has_moved_to(root: Path) -> None:
    survivor = Outcome("code.py", 11, "NumberReplacer", "return value + 0.5", "return value + 1.5", "", 4)
    noticed = Outcome("code.py", 6, "NumberReplacer", "largest: float | int = 3", "... = 4", "failed", 1)
    gone = Outcome("code.py", 6, "NumberReplacer", "smallest = 3", "smallest = 4", "", 1)
    (mutant,) = not_noticed_before([survivor, noticed, gone], root)
    assert mutant.line == SOURCE.splitlines().index("    return value + 0.5") + 1
    assert "value + 1.5" in mutant.code(SOURCE)


TESTS = """
from pathlib import Path

def test_clipping():
    assert "low: int = 1" in Path("code.py").read_text()

def test_in_real_time():
    assert False, "the machine is busy"
"""


@pytest.mark.slow
@pytest.mark.parametrize(("test", "said"), [("test_clipping", "failed"), ("test_in_real_time", "")])
def test_a_test_that_fails_without_the_fault_too_notices_nothing(root: Path, test: str, said: str) -> None:
    (root / "test_code.py").write_text(TESTS)
    mutated = SOURCE.replace("low: int = 1", "low: int = 2")
    assert Trial(root).notices("code.py", mutated, [f"test_code.py::{test}"], 0.1) == said
    assert (root / "code.py").read_text() == SOURCE


def test_every_explanation_is_of_code_that_stands_there() -> None:
    for (file, code, fault), why in explained().items():
        assert code in {line.strip() for line in Path(file).read_text("utf-8").splitlines()}, (file, code)
        assert fault != code
        assert why
