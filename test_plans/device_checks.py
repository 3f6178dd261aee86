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
    Holding,
    Metric,
    StabilityOscillation,
    StabilityTorqueRequest,
    TimeToTolerance,
)

_TITLES = {
    "response_time": "Response time to within the tolerance",
    "arrival": "Steady-state deviation from the request",
    "holding": "Largest deviation while holding",
    "stability_oscillation": "Sustained oscillation, without declared wheel orders",
    "stability_torque_request": "Share of time at the torque limit or opposite to the request",
}
#: Names of the checks, as they end the ids of their criteria.
CHECKS = tuple(_TITLES)
#: What follows a step of each quantity.
_FOLLOWS = {"driving_torque": "shaft_torque_nm", "motor_torque": "motor_torque_nm"}
#: Steps between smaller torques are judged as if they were between such: below lie friction and sensors.
_LEAST_NM = {"driving_torque": 25.0, "motor_torque": 3.0}
#: Of the time after the step: the mean at its end, and what is left for the response.
_LONGEST_MEAN_S, _MEAN_SHARE, _RESPONSE_SHARE = 2.0, 0.25, 0.5
_LARGEST_MISS_PERCENT = 50.0  # of the step: a response that may miss more is none
_STEPS = ("step", "stairs", "ramp")  # what ends at a level
_LEAST_S = 1.0  # after a step: in less nothing comes to rest


class DeviceChecks(Strict):
    """Limits of the device checks, in % of the largest requested torque; null removes a check."""

    arrival_percent: float | None = Field(
        default=10.0, gt=0, le=1000, description="largest deviation from the request"
    )
    response_s: float | None = Field(
        default=2.0, gt=0, description="longest time until the response is within that deviation, s"
    )
    holding_percent: float | None = Field(
        default=20.0,
        gt=0,
        le=1000,
        description="largest deviation of quarter-second means from the request, in the second half",
    )
    oscillation_percent: float | None = Field(
        default=10.0, gt=0, le=1000, description="largest amplitude of a sustained line"
    )
    at_limit_share: float | None = Field(
        default=0.05,
        gt=0,
        le=1,
        description="largest share of time at the torque limit or opposite to the request",
    )

    def criteria(self, segments: tuple[PlannedSegment, ...]) -> tuple[Criterion, ...]:
        """The criteria of all steps of torque among the segments, in order."""
        return tuple(one for segment in segments if _is_step(segment) for one in self._of(segment))

    def gaps(self, segments: tuple[PlannedSegment, ...]) -> tuple[str, ...]:
        """What is not checked of the steps of torque, one sentence each."""
        steps = [one for one in segments if _moves(one)]
        named = [f"device.{name}" for name in type(self).model_fields if getattr(self, name) is None]
        left_out = [f"the plan takes out {', '.join(named)}"] if named and steps else []
        short = [
            f"segment '{one.id}': {_held_s(one):.3g} s at its last level are too short to judge what "
            f"any device must do, {max(_LEAST_S, one.rise_s):.3g} s would do"
            for one in steps
            if not _is_step(one)
        ]
        others = [
            f"segment '{one.id}': a {one.kind} of driving torque ends at no level that it could be judged by"
            for one in segments
            if one.quantity == "driving_torque" and not _moves(one)
        ]
        return (*left_out, *short, *others)

    def _of(self, segment: PlannedSegment) -> Iterator[Criterion]:
        channel = _FOLLOWS[segment.quantity]
        before, after = segment.reference_before, segment.reference_after
        scale_nm = max(abs(before), abs(after), _LEAST_NM[segment.quantity])
        of_step = scale_nm / abs(after - before)  # the metrics count in percent of the step
        after_s = segment.end_s - segment.step_s
        miss = min(of_step * (self.arrival_percent or 10.0), _LARGEST_MISS_PERCENT)
        if self.response_s is not None:
            metric: Metric = TimeToTolerance(channel=channel, share_percent=100.0 - miss)
            longest_s = min(self.response_s + segment.rise_s, max(_RESPONSE_SHARE * after_s, segment.rise_s))
            yield _criterion(segment, "response_time", metric, upper=longest_s)
        if self.arrival_percent is not None:
            metric = Arrival(channel=channel, mean_s=min(_LONGEST_MEAN_S, _MEAN_SHARE * after_s))
            yield _criterion(segment, "arrival", metric, lower=-miss, upper=miss)
        if self.holding_percent is not None:
            metric = Holding(channel=channel)
            largest = min(of_step * self.holding_percent, 2 * _LARGEST_MISS_PERCENT)
            yield _criterion(segment, "holding", metric, upper=largest)
        if self.oscillation_percent is not None:
            metric = StabilityOscillation(channel=channel)
            largest = self.oscillation_percent / 100 * scale_nm
            yield _criterion(segment, "stability_oscillation", metric, upper=largest)
        if self.at_limit_share is not None and segment.quantity == "driving_torque":
            metric = StabilityTorqueRequest()
            yield _criterion(segment, "stability_torque_request", metric, upper=self.at_limit_share)


def _moves(segment: PlannedSegment) -> bool:
    """Whether a segment asks for another torque at its end than before."""
    return segment.kind in _STEPS and segment.reference_before != segment.reference_after


def _held_s(segment: PlannedSegment) -> float:
    """Time at the last level."""
    return segment.end_s - segment.step_s - segment.rise_s


def _is_step(segment: PlannedSegment) -> bool:
    """Whether there is time enough to judge what comes of it: the second half lies at the last level."""
    return _moves(segment) and _held_s(segment) >= max(_LEAST_S, segment.rise_s) - 1e-9


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
