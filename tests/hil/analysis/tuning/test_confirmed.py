"""Predicted beside measured."""

from hil.analysis.tuning import confirmation
from hil.core.result import CriterionResult


def result(id_, value, upper=None, verdict="pass"):
    return CriterionResult(id=id_, value=value, unit="N m", upper=upper, verdict=verdict)


def test_distances_are_shares_of_the_limit_or_of_the_prediction():
    predicted = [result("a", 300.0, 600.0), result("b", 200.0)]
    told = confirmation(predicted, [result("b", 190.0), result("a", 330.0, 600.0), result("c", 1.0)], 0.05)
    assert [(one.id, one.apart) for one in told.criteria] == [("a", 0.05), ("b", 0.05)]
    assert (told.agrees, told.passed) == (True, True)


def test_more_than_allowed_or_no_value_is_beyond():
    predicted = [result("a", 300.0, 600.0), result("b", 2.0, 4.0)]
    measured = [result("a", 331.0, 600.0, "fail"), result("b", None, 4.0, "error")]
    told = confirmation(predicted, measured, 0.05)
    assert [one.id for one in told.beyond] == ["a", "b"]
    assert not told.passed
