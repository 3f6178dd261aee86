"""What a response is compared with: the values before and after the step that was asked for."""

from __future__ import annotations

from hil.core.channels import CHANNELS
from hil.core.result import Segment
from test_plans.conductor import PlannedSegment
from test_plans.metrics._metric import NoValueError

# The step is in N m of one torque; it is a reference only for channels of the same torque.
_COMPARABLE = {
    "driving_torque": ("shaft_torque_nm", "driving_torque_ref_nm", "driving_torque_est_nm"),
    "motor_torque": ("motor_torque_ref_nm", "motor_torque_nm"),
}


def reference(segment: Segment, given: float | None) -> float:
    """`given`, else the value after the step."""
    return segment.reference_after if given is None else given


def step_size(segment: Segment, given: float | None) -> float:
    """`given`, else the magnitude of the step; NoValueError if there is none."""
    size = abs(segment.reference_after - segment.reference_before) if given is None else given
    if size == 0:
        raise NoValueError("the segment has no step: before and after are the same")
    return size


def not_comparable(segment: PlannedSegment, channel: str, key: str = "") -> str:
    """Objection to comparing `channel` with the step unless `key`, if any, gives the value; else empty."""
    if channel in _COMPARABLE[segment.quantity]:
        return ""
    unit = CHANNELS[channel].unit
    instead = f"give '{key}' in {unit}" if key else f"take {' or '.join(_COMPARABLE[segment.quantity])}"
    return f"{channel} cannot be compared with a step of {segment.quantity}: {instead}"


def no_step(segment: PlannedSegment, key: str = "") -> str:
    """Objection to a segment without a step unless `key`, if there is one, gives its size; else empty."""
    if segment.reference_before == segment.reference_after:
        instead = f"give '{key}', or choose another metric" if key else "choose another metric"
        return f"a {segment.kind} has no step: {instead}"
    return ""
