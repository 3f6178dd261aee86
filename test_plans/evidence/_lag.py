"""Whether T_s comes when N T_m does: a value that is late, held, or drifts is no measurement of this axle.

From rest to rest the area between a linear system's input and its output, over the change of the output, is
its lag, whatever the course of the input. An axle's is some milliseconds: twice its damping ratio over its
natural frequency, and the transport of its frames.
"""

from __future__ import annotations

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array

_LARGEST_S = 0.08
_AFTER_S = 2.0  # looked at after a step: drag and wind hardly change in that time
_ENDS_S = 0.5  # over which the values before and after are taken
_LEAST_NM = 40.0  # between them: less drowns in friction
_MOTOR, _SHAFT = "motor_torque_nm", "shaft_torque_nm"

LAG_IN_WORDS = f"in steps, T_s comes within {1e3 * _LARGEST_S:.0f} ms of N T_m"


def lag_in_words(recording: Recording, segment: Segment) -> dict[str, str]:
    """T_m and T_s of a step, with how late T_s came, where it was too late or too early; else empty."""
    if segment.kind != "step" or _MOTOR not in recording or _SHAFT not in recording:
        return {}
    lag_s = _lag_s(recording, segment)
    if lag_s is None or abs(lag_s) <= _LARGEST_S:
        return {}
    when = "after" if lag_s > 0 else "before"
    text = (
        f"{_SHAFT} comes {abs(lag_s):.2g} s {when} {_MOTOR} in the mean of the step; at most "
        f"{_LARGEST_S:g} s would agree: a sensor is late, holds its value, or drifts"
    )
    return {_MOTOR: text, _SHAFT: text}


def _lag_s(recording: Recording, segment: Segment) -> float | None:
    """The lag of T_s behind T_m; None where the step is too short or too small to tell."""
    before_s = min(_ENDS_S, segment.step_s - segment.start_s)
    end_s = min(segment.end_s, segment.step_s + _AFTER_S)
    if before_s < 0.2 * _ENDS_S or end_s - segment.step_s < 2 * _ENDS_S:
        return None
    first, last = (recording.rows_before(time_s) for time_s in (segment.step_s - before_s, end_s))
    rows = recording.rows(first, last, (_MOTOR, _SHAFT))
    known = np.isfinite(rows[_MOTOR]) & np.isfinite(rows[_SHAFT])
    motor, shaft = rows[_MOTOR][known], rows[_SHAFT][known]
    head, tail = (round(length_s / recording.sample_time_s) for length_s in (before_s, _ENDS_S))
    if len(motor) <= head + tail:
        return None
    at_motor, at_shaft = (_mean(v[-tail:]) - _mean(v[:head]) for v in (motor, shaft))
    if abs(at_shaft) < _LEAST_NM or at_motor == 0.0:
        return None
    expected = _mean(shaft[:head]) + at_shaft / at_motor * (motor - _mean(motor[:head]))
    return float(np.sum(expected - shaft) * recording.sample_time_s / at_shaft)


def _mean(values: Array) -> float:
    """Weighted by a Hann window: vibration has little part in it."""
    weight = 1.0 - np.cos(2 * np.pi * (np.arange(len(values)) + 0.5) / len(values))
    return float(weight @ values / np.sum(weight))
