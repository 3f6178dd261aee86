"""Cutting a channel to a stretch of time, refusing what would mislead, and values around a step."""

from __future__ import annotations

import numpy as np

from hil.core.channels import CHANNELS, TIME
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array, PlannedSegment
from test_plans.metrics._metric import NoValueError

#: A longer pause between samples could hide a peak. 10 ms is a block of bus time.
LARGEST_GAP_S = 0.01


def cut(
    recording: Recording,
    segment: Segment,
    channel: str,
    start_s: float,
    end_s: float,
    *,
    with_end: bool = True,
) -> tuple[Array, Array]:
    """Time stamps and values of `channel` with start_s <= time <= end_s, complete.

    Args:
        with_end: whether the sample at `end_s` itself belongs to the window.

    Raises:
        NoValueError: the segment or the recording is too short, or samples are missing or not finite.
    """
    if channel not in recording:
        recording[channel]  # says which there are
    if recording.samples < 2:
        raise NoValueError(f"the recording has {recording.samples} samples")
    spacing = recording.sample_time_s
    # The last sample of a stretch lies one sample time before its end; half a sample is for jitter.
    grace = 1.5 * spacing
    if end_s > segment.end_s + grace:
        raise NoValueError(
            f"the segment ends {segment.end_s - segment.step_s:.3g} s after the step, "
            f"the window needs {end_s - segment.step_s:.3g} s"
        )
    if end_s - start_s < spacing:
        raise NoValueError("the window is empty")
    last_s = end_s + (0.5 if with_end else -0.5) * spacing
    first, last = (recording.rows_before(time_s) for time_s in (start_s - 0.5 * spacing, last_s))
    rows = recording.rows(first, last, (TIME, channel))
    time, values = rows[TIME], rows[channel]
    if len(time) < 2 or time[0] > start_s + grace or time[-1] < end_s - grace:
        raise NoValueError(f"the recording does not cover the window from {start_s:.3f} s to {end_s:.3f} s")
    missing = int(np.count_nonzero(~np.isfinite(values)))
    if missing:
        raise NoValueError(f"{missing} of {len(values)} samples of {channel} are missing in the window")
    gaps = np.diff(time)
    widest = int(np.argmax(gaps))
    if gaps[widest] > max(LARGEST_GAP_S, grace):
        raise NoValueError(f"the recording has a gap of {gaps[widest]:.3g} s at {time[widest]:.3f} s")
    return time, values


def evenly(time: Array, values: Array) -> tuple[float, Array]:
    """Sample time in seconds, and the values on an even grid of as many samples (linear interpolation)."""
    grid = np.linspace(time[0], time[-1], len(time))
    return float((time[-1] - time[0]) / (len(time) - 1)), np.interp(grid, time, values)


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
