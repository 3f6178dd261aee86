"""From a recording to the criteria's results."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from hil.core.errors import HilError
from hil.core.recording import Recording
from hil.core.result import CriterionResult, CriterionVerdict, Segment
from test_plans.criteria import Criterion
from test_plans.metrics import DidNotSettleError, Metric, NoValueError
from test_plans.plan import Plan


def judge(plan: Plan, recording: Recording, segments: Iterable[Segment]) -> tuple[CriterionResult, ...]:
    """Compute every criterion of `plan`, in the plan's order.

    Never raises: a criterion without a value has a verdict that says so, and a reason. `segments` are the
    stretches that were really recorded, also those of a run that was cut short; nothing is judged in one
    that is not complete.
    """
    recorded = {segment.id: segment for segment in segments}

    known: list[tuple[Metric, str, _Found]] = []  # a value that several criteria compare is computed once

    def found(metric: Metric, segment: str) -> _Found:
        for one, place, value in known:
            if place == segment and one == metric:
                return value
        known.append((metric, segment, _found(metric, segment, recording, recorded)))
        return known[-1][2]

    return tuple(_result(criterion, found) for criterion in plan.criteria)


def _result(criterion: Criterion, found: Callable[[Metric, str], _Found]) -> CriterionResult:
    own = found(criterion.metric, criterion.segment)
    rival = found(criterion.metric, criterion.below) if criterion.below else None
    upper = criterion.upper if rival is None else rival.value
    return CriterionResult(
        id=criterion.id,
        value=own.value,
        unit=criterion.metric.unit,
        upper=upper,
        lower=criterion.lower,
        below=criterion.below or "",
        verdict=_verdict(criterion, own, rival),
        title=criterion.title,
        definition=criterion.definition,
        reason=own.reason or (rival.reason if rival else ""),
    )


@dataclass(frozen=True)
class _Found:
    """A metric's value in one segment; without one `trouble` is the verdict and `reason` tells why."""

    value: float | None = None
    trouble: CriterionVerdict = "error"
    reason: str = ""


def _found(metric: Metric, segment: str, recording: Recording, recorded: dict[str, Segment]) -> _Found:
    if segment not in recorded:
        return _Found(trouble="not_judged", reason=f"segment '{segment}' was not carried out")
    if not recorded[segment].complete:
        ran_s = recorded[segment].end_s - recorded[segment].start_s
        reason = f"segment '{segment}' was stopped after {ran_s:.3g} s"
        return _Found(trouble="not_judged", reason=reason)
    try:
        value = float(metric.compute(recording, recorded[segment]))
    except DidNotSettleError as error:
        return _Found(trouble="did_not_settle", reason=f"segment '{segment}': {error}")
    except (NoValueError, HilError) as error:
        return _Found(reason=f"segment '{segment}': {error}")
    except Exception as error:  # a metric of another package must not cost the run its report
        reason = f"segment '{segment}': the metric failed: {type(error).__name__}: {error}"
        return _Found(reason=reason)
    if not math.isfinite(value):
        return _Found(reason=f"segment '{segment}': the value is {value}")
    return _Found(value)


def _verdict(criterion: Criterion, own: _Found, rival: _Found | None) -> CriterionVerdict:
    if own.value is None:
        return own.trouble
    if rival is not None and rival.value is None and rival.trouble != "did_not_settle":
        return rival.trouble
    if criterion.lower is not None and own.value < criterion.lower:
        return "fail"
    if rival is not None:
        # Lower means lower, not equal; and what settles is below what never does.
        return "pass" if rival.value is None or own.value < rival.value else "fail"
    if criterion.upper is not None and own.value > criterion.upper:
        return "fail"
    return "informational" if criterion.upper is None and criterion.lower is None else "pass"
