"""Predicted beside measured."""

import pytest

from hil.analysis.tuning import confirmation
from hil.core.result import CriterionResult


def result(id_, value, upper=None, verdict="pass"):
    return CriterionResult(id=id_, value=value, unit="N m", upper=upper, verdict=verdict)


def test_distances_are_shares_of_the_limit_or_of_the_larger_value():
    predicted = [result("a", 300.0, 600.0), result("b", 200.0)]
    told = confirmation(predicted, [result("b", 190.0), result("a", 330.0, 600.0), result("c", 1.0)], 0.05)
    assert [(one.id, one.apart) for one in told.criteria] == [("a", 0.05), ("b", 0.05)]
    assert [(one.difference, one.of_limit) for one in told.criteria] == [(30.0, True), (-10.0, False)]
    assert (told.agrees, told.passed) == (True, True)


def test_without_a_limit_no_distance_is_more_than_both_values():
    """What is next to nothing in the prediction is no yardstick for what was measured."""
    predicted = [result("a", 1e-9), result("b", 0.0, 0.0), result("c", 0.0)]
    told = confirmation(predicted, [result("a", 0.4), result("b", 0.3, 0.0), result("c", 0.0)], 0.05)
    assert [one.apart for one in told.criteria] == [pytest.approx(1.0), 1.0, 0.0]


def test_more_than_allowed_or_no_value_is_beyond():
    predicted = [result("a", 300.0, 600.0), result("b", 2.0, 4.0)]
    measured = [result("a", 331.0, 600.0, "fail"), result("b", None, 4.0, "error")]
    told = confirmation(predicted, measured, 0.05)
    assert [one.id for one in told.beyond] == ["a", "b"]
    assert not told.passed
