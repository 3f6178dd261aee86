"""From a recording to the criteria's results; also once more, by the plan that lies in the recording."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from hil.core.errors import HilError
from hil.core.recording import Recording, run_of
from hil.core.result import CriterionResult, CriterionVerdict, RunResult, Segment, verdict_of
from test_plans.criteria import Criterion
from test_plans.evidence import objections, unproven
from test_plans.loading import plan_from_text
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
    judgement = Judgement(plan, measured=measured, device=device)
    for segment in segments:
        judgement.take(recording, segment)
    return judgement.results()


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
            why = "too little torque or speed" + (", or wheels that slide," if segment.slippery else "")
            little = f"segment '{segment.id}': {why}"
            found.append(f"{little} to hold {', '.join(names)} against others")
    return tuple(found)


@dataclass(frozen=True)
class _Found:
    """A metric's value in one segment; without one `trouble` is the verdict and `reason` tells why."""

    value: float | None = None
    trouble: CriterionVerdict = "error"
    reason: str = ""
    standard_error: float = 0.0
    remark: str = ""


class Judgement:
    """A plan's criteria judged segment by segment: of a recording no more is needed than the segment's rows.

    Args:
        measured: whether the channels come from sensors: then each must be proven to have been measured.
        device: whether the checks of what any device must do are made too.
    """

    def __init__(self, plan: Plan, *, measured: bool = True, device: bool = True) -> None:
        self._criteria = (*plan.criteria, *(plan.device_criteria if device else ()))
        self._measured = measured
        self._asked: dict[str, list[Criterion]] = {}
        for one in self._criteria:
            for segment in {one.segment, one.below or one.segment}:
                self._asked.setdefault(segment, []).append(one)
        self._found: dict[str, list[tuple[Metric, _Found]]] = {}

    def take(self, recording: Recording, segment: Segment) -> None:
        """Compute what the criteria ask of one segment.

        Args:
            recording: with the segment's rows, and those of a second around it.
        """
        known = self._found[segment.id] = []
        asked = self._asked.get(segment.id, ())
        doubts = self._doubts(recording, segment) if asked else {}
        for number, criterion in enumerate(asked):
            metric = criterion.metric
            if not any(one == metric for one, _ in known):
                same = [one for one in asked[number:] if one.metric == metric]
                known.append((metric, self._computed(same, recording, segment, doubts)))

    def results(self) -> tuple[CriterionResult, ...]:
        """The result of each criterion, in the plan's order, from the segments that were taken."""
        return tuple(self._result(criterion) for criterion in self._criteria)

    def _result(self, criterion: Criterion) -> CriterionResult:
        own = self._of(criterion.metric, criterion.segment)
        rival = self._of(criterion.metric, criterion.below) if criterion.below else None
        scatter = _STANDARD_ERRORS * math.hypot(own.standard_error, rival.standard_error) if rival else 0.0
        verdict = _verdict(criterion, own, rival, scatter)
        reason = own.reason or (rival.reason if rival else "")
        if verdict == "fail" and not reason and own.remark:
            reason = f"segment '{criterion.segment}': {own.remark}"
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

    def _of(self, metric: Metric, segment: str) -> _Found:
        for one, found in self._found.get(segment, ()):
            if one == metric:
                return found
        return _Found(trouble="not_judged", reason=f"segment '{segment}' was not run")

    def _computed(
        self, criteria: list[Criterion], recording: Recording, segment: Segment, doubts: dict[str, str]
    ) -> _Found:
        """What criteria of the same metric need of one segment."""
        metric = criteria[0].metric
        if not segment.complete:
            return _cut_short(metric, recording, segment)
        doubt = next((doubts[name] for name in metric.channels if name in doubts), "")
        if doubt:
            return _Found(reason=f"segment '{segment.id}': {doubt}")
        found = _value(metric, recording, segment)
        if found.value is None:
            return found
        compared = any(one.below for one in criteria)
        if compared and self._measured:
            found = replace(found, standard_error=standard_error(metric, recording, segment))
        if compared or any(_verdict(one, found, None, 0.0) == "fail" for one in criteria):
            found = replace(found, remark=_remark(metric, recording, segment))
        return found

    def _doubts(self, recording: Recording, segment: Segment) -> dict[str, str]:
        """Why channels were not measured, by name."""
        if not self._measured or not segment.complete:
            return {}
        try:
            return objections(recording, segment)
        except HilError as error:  # a damaged file
            names = (name for one in self._asked[segment.id] for name in one.metric.channels)
            return dict.fromkeys(names, str(error))


def _value(metric: Metric, recording: Recording, segment: Segment) -> _Found:
    place = f"segment '{segment.id}'"
    try:
        value = float(metric.compute(recording, segment))
    except DidNotSettleError as error:
        return _Found(trouble="did_not_settle", reason=f"{place}: {error}")
    except NotReachedError as error:
        return _Found(trouble="fail", reason=f"{place}: {error}")
    except (NoValueError, HilError) as error:
        return _Found(reason=f"{place}: {error}")
    except Exception as error:  # a metric of another package must not cost the run its report
        return _Found(reason=f"{place}: the metric failed: {type(error).__name__}: {error}")
    if not math.isfinite(value):
        return _Found(reason=f"{place}: the value is {value}")
    return _Found(value)


def _remark(metric: Metric, recording: Recording, segment: Segment) -> str:
    """What a reader should know of a value that fails."""
    try:
        return metric.remark(recording, segment)
    except (NoValueError, HilError):
        return ""


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


def rejudged(recording: Recording) -> RunResult | None:
    """The run's result with its criteria computed again; None for a recording without a run."""
    stored = run_of(recording)
    if stored is None:
        return None
    where = str(recording.source)
    text = recording.attachments.get("plan.yaml", b"").decode(errors="replace")
    plan = plan_from_text(text, f"{where}: plan.yaml", recording.source.parent, files_required=False)
    criteria = judge(plan, recording, stored.segments)
    reason = stored.reason
    if recording.damage:  # what is lost or changed somewhere proves nothing anywhere
        reason = "\n".join(
            [*([reason] if reason else []), f"the recording is damaged: {recording.damage[0]}"]
        )
    tripped = "" if recording.damage else stored.limit_tripped
    unchecked = not_checked(plan, recording, stored.segments)
    verdict = verdict_of(criteria, stopped=reason != "", limit_tripped=tripped)
    changes = {"criteria": criteria, "verdict": verdict, "reason": reason, "not_checked": unchecked}
    return stored.model_copy(update=changes)
