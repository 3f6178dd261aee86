from __future__ import annotations

import pytest

from hil.core.result import CriterionResult, RunResult
from reports.criteria import CriterionRow, criteria_table, in_words


def row(result: RunResult, **given: object) -> CriterionRow:
    fields = {"id": "a.b", "value": 1.0, "unit": "N m", "verdict": "pass"} | given
    criterion = CriterionResult.model_validate(fields)
    return criteria_table(result.model_copy(update={"criteria": (criterion,)})).groups[0].rows[0]


def test_rows_stand_under_their_segment_in_the_plans_order(result: RunResult) -> None:
    extra = CriterionResult(id="order.peak", value=-53.0, unit="N m", upper=0.0, verdict="pass")
    table = criteria_table(result.model_copy(update={"criteria": (*result.criteria, extra)}))
    titles = [group.title for group in table.groups]
    assert titles[0] == "Gain stabilization, 0\u202fkm/h (gain_0kmh)"
    assert titles[-1] == "Whole run"
    assert [r.id for group in table.groups for r in group.rows] == [
        *(c.id for c in result.criteria),
        extra.id,
    ]


def test_definitions_are_told_once(result: RunResult) -> None:
    table = criteria_table(result)
    assert len(table.definitions) == 4
    assert [r.definition for r in table.groups[2].rows] == [1, 2, 3, 4]


@pytest.mark.parametrize(
    ("limits", "text"),
    [
        ({"upper": 564.0}, "≤\u202f564"),
        ({"lower": 0.25}, "≥\u202f0.25"),
        ({"lower": -1.0, "upper": 2.0}, "−1 to 2"),
        ({}, "–"),
    ],
)
def test_limits(result: RunResult, limits: dict[str, float], text: str) -> None:
    assert row(result, **limits).limit == text


def test_a_narrow_miss_is_not_rounded_away(result: RunResult) -> None:
    narrow = row(result, value=564.0003, upper=564.0, verdict="fail")
    assert narrow.margin == "−5\u202f×\u202f10⁻⁵\u202f%"  # -0.0003 of 564
    assert narrow.value != narrow.limit.removeprefix("≤\u202f")


def test_no_value_shows_as_a_dash_with_its_reason(result: RunResult) -> None:
    missing = row(result, value=None, upper=1.0, verdict="error", reason="no channel")
    assert (missing.value, missing.margin, missing.reason) == ("–", "–", "no channel")


def test_words_for_messages() -> None:
    failed = CriterionResult(id="a.b", value=600.0, unit="N m", upper=564.0, verdict="fail")
    assert in_words(failed) == "600.0\u202fN\u202fm, allowed is ≤\u202f564\u202fN\u202fm"


@pytest.mark.parametrize(
    ("value", "text"),
    [(376.0, "33.3\u202f%"), (36255.0, "−6330\u202f%"), (5e9, "<\u202f−100\u202f000\u202f%")],
)
def test_a_margin_far_beyond_its_limit_is_a_multiple(result: RunResult, value: float, text: str) -> None:
    assert row(result, value=value, upper=564.0, verdict="fail").margin == text
