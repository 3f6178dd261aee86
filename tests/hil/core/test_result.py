"""Margins and verdicts: a share of the nearest limit, positive inside."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from hil.core.result import CriterionResult, CriterionVerdict, RunResult, Segment, verdict_of


def criterion(
    value: float | None = 1.0, verdict: CriterionVerdict = "pass", **limits: Any
) -> CriterionResult:
    return CriterionResult(id="s.peak", value=value, unit="N m", verdict=verdict, **limits)


@pytest.mark.parametrize(
    ("value", "limits", "margin"),
    [
        (300.0, {"upper": 400.0}, 0.25),
        (500.0, {"upper": 400.0}, -0.25),
        (300.0, {"lower": 200.0}, 0.5),
        (-300.0, {"lower": -400.0}, 0.25),
        (300.0, {"lower": 200.0, "upper": 400.0}, 0.25),
        (210.0, {"lower": 200.0, "upper": 400.0}, 0.05),
        (300.0, {"lower": 0.0, "upper": 400.0}, 0.25),
        (300.0, {"lower": 0.0}, None),
        (300.0, {}, None),
        (None, {"upper": 400.0}, None),
    ],
)
def test_the_margin_is_the_nearest_limits(value: float | None, limits: dict[str, Any], margin: float) -> None:
    assert criterion(value, **limits).margin == (None if margin is None else pytest.approx(margin))


@pytest.mark.parametrize(
    ("verdict", "limits", "failed"),
    [
        ("fail", {"upper": 1.0}, True),
        ("pass", {"upper": 1.0}, False),
        ("did_not_settle", {"upper": 1.0}, True),
        ("did_not_settle", {"lower": 1.0}, True),
        ("did_not_settle", {"below": "gain"}, True),
        ("did_not_settle", {}, False),
        ("informational", {}, False),
    ],
)
def test_what_never_settles_fails_where_a_limit_asks_for_it(
    verdict: CriterionVerdict, limits: dict[str, Any], failed: bool
) -> None:
    assert criterion(verdict=verdict, **limits).failed is failed


@pytest.mark.parametrize(
    ("verdicts", "stopped", "run"),
    [
        ((), False, "done"),
        ((), True, "error"),
        (("pass", "informational"), False, "pass"),
        (("pass", "fail"), False, "fail"),
        (("fail", "error"), False, "error"),
        (("fail", "not_judged"), False, "error"),
        (("fail",), True, "error"),
    ],
)
def test_a_runs_verdict(verdicts: tuple[CriterionVerdict, ...], stopped: bool, run: str) -> None:
    assert verdict_of((criterion(verdict=one, upper=1.0) for one in verdicts), stopped=stopped) == run


def test_what_only_the_device_checks_judge_passes_nothing_but_may_fail() -> None:
    kept, broken = (criterion(verdict=one, upper=1.0, source="device") for one in ("pass", "fail"))
    assert verdict_of([kept], stopped=False) == "done"
    assert verdict_of([kept, broken], stopped=False) == "fail"


def test_a_limit_that_an_unstable_device_tripped_is_a_failure_of_the_device() -> None:
    left = criterion(verdict="not_judged", upper=1.0)
    unstable = criterion(verdict="fail", upper=1.0, source="device")
    assert verdict_of([left, unstable], stopped=True, limit_tripped="T_s") == "fail"
    assert verdict_of([left], stopped=True, limit_tripped="T_s") == "error"
    assert verdict_of([left, unstable], stopped=True) == "error"


def test_a_segment_says_only_what_was_so() -> None:
    segment = Segment(id="s", start_s=0.0, step_s=1.0, end_s=2.0)
    assert (segment.reference_before, segment.reference_after, segment.initial_speed_km_h) == (0.0, 0.0, 0.0)
    assert segment.complete
    assert (segment.kind, segment.load, segment.controller) == ("step", "vehicle", "")


def test_results_are_not_changed_and_hold_nothing_unknown() -> None:
    one: Any = criterion()
    with pytest.raises(ValidationError):
        one.value = 2.0
    with pytest.raises(ValidationError, match="colour"):
        RunResult.model_validate({"colour": 1})
