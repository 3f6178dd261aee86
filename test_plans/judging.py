"""From a recording to the criteria's results."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from hil.core.errors import HilError
from hil.core.recording import Recording
from hil.core.result import CriterionResult, CriterionVerdict, Segment
from test_plans.criteria import Criterion
from test_plans.evidence import objections, unproven
from test_plans.metrics import (
    DidNotSettleError,
    Metric,
    NotReachedError,
    NoValueError,
    StabilityOscillation,
    instability,
)
from test_plans.plan import Plan
from test_plans.scatter import standard_error

_STANDARD_ERRORS = 2.0  # between two values that are compared


def judge(
    plan: Plan,
    recording: Recording,
    segments: Iterable[Segment],
    *,
    measured: bool = True,
    device: bool = True,
) -> tuple[CriterionResult, ...]:
    """Compute every criterion of `plan`, in the plan's order, then what any device must do.

    Never raises: a criterion without a value has a verdict that says so, and a reason. `segments` are the
    stretches that were really recorded, also those of a run that was cut short; nothing is judged in one
    that is not complete, but that the loop was growing when it was ended.

    Args:
        measured: whether the channels come from sensors: then each must be proven to have been measured.
        device: whether the checks of what any device must do are made too.
    """
    judgement = _Judgement(recording, {segment.id: segment for segment in segments}, measured)
    criteria = (*plan.criteria, *(plan.device_criteria if device else ()))
    return tuple(judgement.of(criterion) for criterion in criteria)


def not_checked(plan: Plan, recording: Recording, segments: Iterable[Segment]) -> tuple[str, ...]:
    """What any device must do that is not checked, and what criteria use that nothing proves; sentences.

    Never raises.
    """
    asked: dict[str, dict[str, None]] = {}
    for one in (*plan.criteria, *plan.device_criteria):
        asked.setdefault(one.segment, {}).update(dict.fromkeys(one.metric.channels))
    found = list(plan.device_gaps)
    for segment in segments:
        try:
            names = unproven(recording, segment, asked.get(segment.id, {})) if segment.complete else ()
        except HilError:  # a damaged file
            continue
        if names:
            little = f"segment '{segment.id}': too little torque or speed"
            found.append(f"{little} to hold {', '.join(names)} against others")
    return tuple(found)


@dataclass(frozen=True)
class _Found:
    """A metric's value in one segment; without one `trouble` is the verdict and `reason` tells why."""

    value: float | None = None
    trouble: CriterionVerdict = "error"
    reason: str = ""


class _Judgement:
    """Values and evidence of one recording, each computed once."""

    def __init__(self, recording: Recording, recorded: dict[str, Segment], measured: bool) -> None:
        self._recording, self._recorded, self._measured = recording, recorded, measured
        self._known: list[tuple[Metric, str, _Found]] = []
        self._objections: dict[str, dict[str, str]] = {}

    def of(self, criterion: Criterion) -> CriterionResult:
        """The result of one criterion."""
        own = self._found(criterion.metric, criterion.segment)
        rival = self._found(criterion.metric, criterion.below) if criterion.below else None
        scatter = self._scatter(criterion, own, rival)
        verdict = _verdict(criterion, own, rival, scatter)
        reason = own.reason or (rival.reason if rival else "")
        if verdict == "fail" and not reason:
            reason = self._remark(criterion)
        if verdict == "undecided":
            reason = (
                f"segments '{criterion.segment}' and '{criterion.below}' differ by less than noise alone "
                f"moves them: two standard errors are {scatter:.2g} {criterion.metric.unit}"
            )
        return CriterionResult(
            id=criterion.id,
            value=own.value,
            unit=criterion.metric.unit,
            upper=criterion.upper if rival is None else rival.value,
            lower=criterion.lower,
            below=criterion.below or "",
            verdict=verdict,
            title=criterion.title,
            definition=criterion.definition,
            reason=reason,
            source=criterion.source,
        )

    def _found(self, metric: Metric, segment: str) -> _Found:
        """The metric's value; one that several criteria compare is computed once."""
        for one, place, value in self._known:
            if place == segment and one == metric:
                return value
        self._known.append((metric, segment, self._computed(metric, segment)))
        return self._known[-1][2]

    def _computed(self, metric: Metric, id_: str) -> _Found:
        if id_ not in self._recorded:
            return _Found(trouble="not_judged", reason=f"segment '{id_}' was not carried out")
        segment = self._recorded[id_]
        if not segment.complete:
            return _cut_short(metric, self._recording, segment)
        doubt = self._doubt(metric, segment)
        if doubt:
            return _Found(reason=f"segment '{id_}': {doubt}")
        try:
            value = float(metric.compute(self._recording, segment))
        except DidNotSettleError as error:
            return _Found(trouble="did_not_settle", reason=f"segment '{id_}': {error}")
        except NotReachedError as error:
            return _Found(trouble="fail", reason=f"segment '{id_}': {error}")
        except (NoValueError, HilError) as error:
            return _Found(reason=f"segment '{id_}': {error}")
        except Exception as error:  # a metric of another package must not cost the run its report
            reason = f"segment '{id_}': the metric failed: {type(error).__name__}: {error}"
            return _Found(reason=reason)
        if not math.isfinite(value):
            return _Found(reason=f"segment '{id_}': the value is {value}")
        return _Found(value)

    def _remark(self, criterion: Criterion) -> str:
        """What a reader should know of a value beyond its limit."""
        try:
            remark = criterion.metric.remark(self._recording, self._recorded[criterion.segment])
        except (NoValueError, HilError):
            return ""
        return f"segment '{criterion.segment}': {remark}" if remark else ""

    def _doubt(self, metric: Metric, segment: Segment) -> str:
        """Why the metric's channels were not measured; '' if they were."""
        if not self._measured:
            return ""
        if segment.id not in self._objections:
            try:
                self._objections[segment.id] = objections(self._recording, segment)
            except HilError as error:  # a damaged file
                self._objections[segment.id] = dict.fromkeys(metric.channels, str(error))
        known = self._objections[segment.id]
        return next((known[name] for name in metric.channels if name in known), "")

    def _scatter(self, criterion: Criterion, own: _Found, rival: _Found | None) -> float:
        """Two standard errors of the difference of the two values that a criterion compares."""
        if rival is None or own.value is None or rival.value is None or not self._measured:
            return 0.0
        places = (criterion.segment, criterion.below or "")
        errors = (
            standard_error(criterion.metric, self._recording, self._recorded[place]) for place in places
        )
        return _STANDARD_ERRORS * math.hypot(*errors)


def _cut_short(metric: Metric, recording: Recording, segment: Segment) -> _Found:
    """Of a segment that was stopped: nothing, unless its loop was growing, a failure of the device."""
    ran_s = segment.end_s - segment.start_s
    reason = f"segment '{segment.id}' was stopped after {ran_s:.3g} s"
    unstable = instability(recording, segment) if isinstance(metric, StabilityOscillation) else ""
    if unstable:
        return _Found(trouble="fail", reason=f"{reason}; {unstable}: the control loop is not stable")
    return _Found(trouble="not_judged", reason=reason)


def _verdict(criterion: Criterion, own: _Found, rival: _Found | None, scatter: float) -> CriterionVerdict:
    has_limit = criterion.upper is not None or criterion.lower is not None or rival is not None
    if own.value is None:
        return "informational" if own.trouble == "fail" and not has_limit else own.trouble
    if rival is not None and rival.value is None and rival.trouble != "did_not_settle":
        return "error" if rival.trouble == "fail" else rival.trouble
    if criterion.lower is not None and own.value < criterion.lower:
        return "fail"
    if rival is not None:
        if rival.value is None:  # what settles is below what never does
            return "pass"
        # Lower means lower, not equal, and by more than noise would make it.
        if abs(rival.value - own.value) <= scatter and own.value != rival.value:
            return "undecided"
        return "pass" if own.value < rival.value else "fail"
    if criterion.upper is not None and own.value > criterion.upper:
        return "fail"
    return "pass" if has_limit else "informational"
