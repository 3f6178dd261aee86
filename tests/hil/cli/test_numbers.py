"""Numbers of tables and sentences of commands (docs/reference/numbers.md)."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from hil.analysis.tuning import confirmation
from hil.app.autotune.loop import _off
from hil.app.tuning.refinement import FirstRun
from hil.cli.commands import tune
from hil.cli.output import print_criteria
from hil.core.result import CriterionResult


def _result(id_: str, value: float, upper: float | None = None) -> CriterionResult:
    verdict = "informational" if upper is None else "pass" if value <= upper else "fail"
    return CriterionResult(id=id_, value=value, unit="N m", upper=upper, verdict=verdict)


def test_margins_in_the_table_of_a_run_have_digits_that_mean_something() -> None:
    page = Console(file=io.StringIO(), width=200)
    far = (_result("a.peak", 376.0, 564.0), _result("b.peak", 36255.0, 564.0), _result("c.peak", 20.0, 1.0))
    print_criteria(page, far)
    text = page.file.getvalue()  # type: ignore[attr-defined]
    for said in (" 33.3 % ", " -6330 % ", " -1900 % "):
        assert said in text
    assert "%%" not in text
    assert "6328" not in text


def test_a_difference_stands_in_its_unit_and_against_the_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Next to nothing was predicted of one criterion, which has no limit."""
    predicted = [_result("a.peak", 300.0, 600.0), _result("b.energy", 1e-9)]
    measured = [_result("a.peak", 330.0, 600.0), _result("b.energy", 0.3952982)]
    page = Console(file=io.StringIO(), width=200)
    monkeypatch.setattr(tune, "console", lambda: page)
    tune._print_first_run(FirstRun(confirmation(predicted, measured, 0.02), "diagnosis"))
    text = page.file.getvalue()  # type: ignore[attr-defined]
    rows = {
        line.split()[0]: line.split()[1:]
        for line in text.splitlines()
        if ".peak" in line or ".energy" in line
    }
    assert rows["a.peak"][:7] == ["300", "330", "+30", "N", "m", "5.00", "%"]
    assert rows["b.energy"][:6] == ["1e-09", "0.3953", "+0.395", "N", "m", "-"]
    assert "of the larger value where there is none" in text


def test_autotune_says_by_how_much_a_prediction_is_off_and_in_what() -> None:
    predicted = [_result("a.peak", 300.0, 600.0), _result("b.energy", 1e-9)]
    one = confirmation(predicted, [_result("a.peak", 330.0, 600.0)], 0.02)
    assert _off(one) == "off by up to 5.00 % of its limit (a peak: +30 N m)"
    both = confirmation(predicted, [_result("a.peak", 330.0, 600.0), _result("b.energy", 0.4)], 0.02)
    assert _off(both) == "off by up to 100.00 % of the larger value, without a limit (b energy: +0.4 N m)"
    assert _off(confirmation(predicted[:1], predicted[:1], 0.02)) == "exact"
