"""Runs of one plan side by side: criteria, and how far responses are apart."""

from hil.analysis.comparison._comparison import Comparison, CriterionRow, ResponseRow, compare, difference
from hil.analysis.comparison._runs import ComparedRun, controllers_that_differ, refuse_other_plans

__all__ = [
    "ComparedRun",
    "Comparison",
    "CriterionRow",
    "ResponseRow",
    "compare",
    "controllers_that_differ",
    "difference",
    "refuse_other_plans",
]
