"""From a recording to the criteria's results."""

from __future__ import annotations

import math
from collections.abc import Iterable

from hil.core.errors import HilError
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment, Verdict
from test_plans.criteria import Criterion
from test_plans.metrics import Metric, NoValueError
from test_plans.plan import Plan


def judge(plan: Plan, recording: Recording, segments: Iterable[Segment]) -> tuple[CriterionResult, ...]:
    """Compute every criterion of `plan`, in the plan's order.

    Never raises: a criterion without a value has the verdict 'error' and a reason. `segments` are the
    stretches that were really recorded, also those of a run that was cut short.
    """
    recorded = {segment.id: segment for segment in segments}
    return tuple(_result(criterion, recording, recorded) for criterion in plan.criteria)


def _result(criterion: Criterion, recording: Recording, recorded: dict[str, Segment]) -> CriterionResult:
    value: float | None = None
    upper = criterion.upper
    reason = ""
    try:
        value = _value(criterion.metric, criterion.segment, recording, recorded)
        if criterion.below is not None:
            upper = _value(criterion.metric, criterion.below, recording, recorded)
    except (NoValueError, HilError) as error:
        reason = str(error)
    except Exception as error:  # a metric of another package must not cost the run its report
        reason = f"the metric failed: {type(error).__name__}: {error}"
    return CriterionResult(
        id=criterion.id,
        value=value,
        unit=criterion.metric.unit,
        upper=upper,
        lower=criterion.lower,
        verdict="error" if reason or value is None else _verdict(criterion, value, upper),
        title=criterion.title,
        definition=criterion.definition,
        reason=reason,
    )


def _value(metric: Metric, segment: str, recording: Recording, recorded: dict[str, Segment]) -> float:
    if segment not in recorded:
        raise NoValueError(f"segment '{segment}' was not recorded")
    try:
        value = float(metric.compute(recording, recorded[segment]))
    except NoValueError as error:
        raise NoValueError(f"segment '{segment}': {error}") from error
    if not math.isfinite(value):
        raise NoValueError(f"segment '{segment}': the value is {value}")
    return value


def _verdict(criterion: Criterion, value: float, upper: float | None) -> Verdict:
    if criterion.lower is not None and value < criterion.lower:
        return "fail"
    if upper is None:
        return "pass"
    # Below another segment means lower, not equal; a limit may be reached.
    inside = value < upper if criterion.below is not None else value <= upper
    return "pass" if inside else "fail"
