"""What any device must do, whatever a plan's author asks: the request arrives, and the loop comes to rest.

The criteria that come of it stand beside the author's in result and report. They need no limit by the author:
what was asked for is in the plan. A plan changes the bounds under the key `device`.
"""

from __future__ import annotations

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
    "response_time": "90 % of the step is reached",
    "arrival": "What was asked for arrives",
    "stability_oscillation": "Oscillation at the end, without the orders of the wheel",
    "stability_torque_request": "Share of time at the torque limit, or against the request",
}
#: Names of the checks, as they end the ids of their criteria.
CHECKS = tuple(_TITLES)
#: What follows a step of each quantity.
_FOLLOWS = {"driving_torque": "shaft_torque_nm", "motor_torque": "motor_torque_nm"}
#: Of the time after the step: the mean at its end, and what is left for the response.
_LONGEST_MEAN_S, _MEAN_SHARE, _RESPONSE_SHARE = 2.0, 0.25, 0.5
_LEAST_S = 1.0  # after a step: in less nothing comes to rest


class DeviceChecks(Strict):
    """Bounds of what any device must do; null takes a check out."""

    arrival_percent: float | None = Field(
        default=10.0, gt=0, le=1000, description="largest distance from what was asked, % of the step"
    )
    response_s: float | None = Field(default=2.0, gt=0, description="longest time to 90 % of a step, s")
    oscillation_percent: float | None = Field(
        default=10.0, gt=0, le=1000, description="largest line that does not decay, % of the step"
    )
    at_limit_share: float | None = Field(
        default=0.05,
        gt=0,
        le=1,
        description="largest share of time at the torque limit or against the request",
    )

    def criteria(self, segments: tuple[PlannedSegment, ...]) -> tuple[Criterion, ...]:
        """The criteria of all steps of torque among the segments, in order."""
        return tuple(one for segment in segments if is_step(segment) for one in self._of(segment))

    def _of(self, segment: PlannedSegment) -> list[Criterion]:
        found = []
        after_s = segment.end_s - segment.step_s
        channel = _FOLLOWS[segment.quantity]
        size = abs(segment.reference_after - segment.reference_before)
        if self.response_s is not None:
            metric: Metric = ResponseTime(channel=channel)
            longest_s = min(self.response_s, _RESPONSE_SHARE * after_s)
            found.append(_criterion(segment, "response_time", metric, upper=longest_s))
        if self.arrival_percent is not None:
            metric = Arrival(channel=channel, mean_s=min(_LONGEST_MEAN_S, _MEAN_SHARE * after_s))
            bound = self.arrival_percent
            found.append(_criterion(segment, "arrival", metric, lower=-bound, upper=bound))
        if segment.quantity != "driving_torque":
            return found  # no loop: the motor's torque is what was asked for
        if self.oscillation_percent is not None:
            metric = StabilityOscillation(channel="shaft_torque_nm")
            largest = self.oscillation_percent / 100 * size
            found.append(_criterion(segment, "stability_oscillation", metric, upper=largest))
        if self.at_limit_share is not None:
            metric = StabilityTorqueRequest()
            found.append(_criterion(segment, "stability_torque_request", metric, upper=self.at_limit_share))
        return found


def is_step(segment: PlannedSegment) -> bool:
    """Whether a segment is a step of torque with time enough to judge what comes of it."""
    moved = segment.reference_before != segment.reference_after
    return segment.kind == "step" and moved and segment.end_s - segment.step_s >= _LEAST_S


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
