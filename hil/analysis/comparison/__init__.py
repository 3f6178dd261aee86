"""Runs of one plan side by side: criteria, and how far responses are apart."""

from hil.analysis.comparison._comparison import (
    Comparison,
    CriterionRow,
    ResponseRow,
    aligned,
    compare,
    difference,
)
from hil.analysis.comparison._runs import (
    ComparedRun,
    Difference,
    controllers_that_differ,
    differences,
    names_by_variables,
    refuse_other_plans,
)

__all__ = [
    "ComparedRun",
    "Comparison",
    "CriterionRow",
    "Difference",
    "ResponseRow",
    "aligned",
    "compare",
    "controllers_that_differ",
    "difference",
    "differences",
    "names_by_variables",
    "refuse_other_plans",
]
