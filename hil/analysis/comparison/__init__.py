"""Runs side by side: criteria, how far responses are apart, and what each was given otherwise."""

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
    PlanSummary,
    controllers_that_differ,
    differences,
    names_by_variables,
    plan_summary,
)

__all__ = [
    "ComparedRun",
    "Comparison",
    "CriterionRow",
    "Difference",
    "PlanSummary",
    "ResponseRow",
    "aligned",
    "compare",
    "controllers_that_differ",
    "difference",
    "differences",
    "names_by_variables",
    "plan_summary",
]
