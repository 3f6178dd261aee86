"""What any device must do, whatever a plan's author asks: the request arrives, and the loop comes to rest.

The criteria that come of it stand beside the author's in result and report. They need no limit by the author:
what was asked for is in the plan. A plan changes the bounds under the key `device`.
"""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field

from test_plans.building import Strict
from test_plans.conductor import PlannedSegment
from test_plans.criteria import Criterion
from test_plans.metrics import (
    Arrival,
    Metric,
    ResponseTime,
    StabilityOscillation,
    StabilityTorqueRequest,
)

_TITLES = {
    "response_time": "The response reaches what was asked, to within the bound of arrival",
    "arrival": "What was asked for arrives",
    "stability_oscillation": "Oscillation that lasts, without the declared orders of the wheel",
    "stability_torque_request": "Share of time at the torque limit, or against the request",
}
#: Names of the checks, as they end the ids of their criteria.
CHECKS = tuple(_TITLES)
#: What follows a step of each quantity.
_FOLLOWS = {"driving_torque": "shaft_torque_nm", "motor_torque": "motor_torque_nm"}
#: Steps between smaller torques are judged as if they were between such: below lie friction and sensors.
_LEAST_NM = {"driving_torque": 25.0, "motor_torque": 3.0}
#: Of the time after the step: the mean at its end, and what is left for the response.
_LONGEST_MEAN_S, _MEAN_SHARE, _RESPONSE_SHARE = 2.0, 0.25, 0.5
_LARGEST_MISS_PERCENT = 50.0  # of the step: a response that may miss more has no time
_LEAST_S = 1.0  # after a step: in less nothing comes to rest


class DeviceChecks(Strict):
    """Bounds of what any device must do, in % of the largest torque asked for; null takes a check out."""

    arrival_percent: float | None = Field(
        default=10.0, gt=0, le=1000, description="largest distance from what was asked"
    )
    response_s: float | None = Field(
        default=2.0, gt=0, description="longest time until the response is as near as that, s"
    )
    oscillation_percent: float | None = Field(
        default=10.0, gt=0, le=1000, description="largest amplitude of a line that lasts"
    )
    at_limit_share: float | None = Field(
        default=0.05,
        gt=0,
        le=1,
        description="largest share of time at the torque limit or against the request",
    )

    def criteria(self, segments: tuple[PlannedSegment, ...]) -> tuple[Criterion, ...]:
        """The criteria of all steps of torque among the segments, in order."""
        return tuple(one for segment in segments if _is_step(segment) for one in self._of(segment))

    def gaps(self, segments: tuple[PlannedSegment, ...]) -> tuple[str, ...]:
        """What is not checked of the steps of torque, one sentence each."""
        steps = [one for one in segments if _is_step(one, least_s=0.0)]
        named = [f"device.{name}" for name in type(self).model_fields if getattr(self, name) is None]
        left_out = [f"the plan takes out {', '.join(named)}"] if named and steps else []
        short = [
            f"segment '{one.id}': {one.end_s - one.step_s:.3g} s after the step are too short to judge what "
            f"any device must do, {_LEAST_S:g} s would do"
            for one in steps
            if not _is_step(one)
        ]
        return (*left_out, *short)

    def _of(self, segment: PlannedSegment) -> Iterator[Criterion]:
        channel = _FOLLOWS[segment.quantity]
        before, after = segment.reference_before, segment.reference_after
        scale_nm = max(abs(before), abs(after), _LEAST_NM[segment.quantity])
        of_step = scale_nm / abs(after - before)  # the metrics count in percent of the step
        after_s = segment.end_s - segment.step_s
        miss = of_step * (self.arrival_percent or 10.0)
        if self.response_s is not None and miss <= _LARGEST_MISS_PERCENT:
            metric: Metric = ResponseTime(channel=channel, share_percent=100.0 - miss)
            longest_s = min(self.response_s, _RESPONSE_SHARE * after_s)
            yield _criterion(segment, "response_time", metric, upper=longest_s)
        if self.arrival_percent is not None:
            metric = Arrival(channel=channel, mean_s=min(_LONGEST_MEAN_S, _MEAN_SHARE * after_s))
            yield _criterion(segment, "arrival", metric, lower=-miss, upper=miss)
        if self.oscillation_percent is not None:
            metric = StabilityOscillation(channel=channel)
            largest = self.oscillation_percent / 100 * scale_nm
            yield _criterion(segment, "stability_oscillation", metric, upper=largest)
        if self.at_limit_share is not None and segment.quantity == "driving_torque":
            metric = StabilityTorqueRequest()
            yield _criterion(segment, "stability_torque_request", metric, upper=self.at_limit_share)


def _is_step(segment: PlannedSegment, least_s: float = _LEAST_S) -> bool:
    """Whether a segment is a step of torque with time enough to judge what comes of it."""
    moved = segment.reference_before != segment.reference_after
    return segment.kind == "step" and moved and segment.end_s - segment.step_s >= least_s - 1e-9


def _criterion(
    segment: PlannedSegment,
    name: str,
    metric: Metric,
    *,
    lower: float | None = None,
    upper: float | None = None,
) -> Criterion:
    return Criterion(
        id=f"{segment.id}.{name}",
        segment=segment.id,
        metric=metric,
        lower=lower,
        upper=upper,
        title=_TITLES[name],
        source="device",
    )
