"""What a step of torque does to the axle: T_s comes when N T_m does, and the wheels accelerate with it.

From rest to rest the area between a linear system's input and its output, over the change of the output, is
its lag, whatever the course of the input. An axle's is some milliseconds: twice its damping ratio over its
natural frequency, and the transport of its frames. A value that is late, held, or drifts has another.

T_s over the wheels' acceleration is the inertia that the dynos simulate: a car's, whichever it is.
"""

from __future__ import annotations

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array
from test_plans.metrics import hann

_LARGEST_S = 0.08
_AFTER_S = 2.0  # looked at after a step: drag and wind hardly change in that time
_ENDS_S = 0.5  # over which the values before and after are taken
_LEAST_NM = 40.0  # between them: less drowns in friction
_MOTOR, _SHAFT, _WHEEL = "motor_torque_nm", "shaft_torque_nm", "wheel_speed_rad_s"
_LIGHTEST_KG_M2, _HEAVIEST_KG_M2 = 10.0, 3000.0  # at the wheels: 100 kg on 0.3 m, 12 t on 0.5 m
_LEAST_RAD_S = 0.05  # by which the wheels' speeds have to differ from where they would have been

LAG_IN_WORDS = f"in steps, T_s comes within {1e3 * _LARGEST_S:.0f} ms of N T_m"
INERTIA_IN_WORDS = (
    f"in steps under a vehicle, T_s over the acceleration is {_LIGHTEST_KG_M2:g} to {_HEAVIEST_KG_M2:g} kg m²"
)


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


def inertia_in_words(recording: Recording, segment: Segment) -> dict[str, str]:
    """T_s and wheel speed of a step, with the inertia that they make, where no car has it; else empty."""
    if segment.kind != "step" or segment.load != "vehicle" or segment.slippery:
        return {}
    if _SHAFT not in recording or _WHEEL not in recording:
        return {}
    inertia = _inertia_kg_m2(recording, segment)
    if inertia is None or _LIGHTEST_KG_M2 <= inertia <= _HEAVIEST_KG_M2:
        return {}
    text = (
        f"{_SHAFT} over the acceleration of {_WHEEL} makes {inertia:.3g} kg m², a car has "
        f"{_LIGHTEST_KG_M2:g} to {_HEAVIEST_KG_M2:g} at its wheels: one of them is dead, scaled or mirrored"
    )
    return {_SHAFT: text, _WHEEL: text}


def _inertia_kg_m2(recording: Recording, segment: Segment) -> float | None:
    """Change of T_s over change of acceleration; None where the step is too short or too small to tell."""
    before_s = min(_AFTER_S, segment.step_s - segment.start_s)
    after_s = min(_AFTER_S, segment.end_s - segment.step_s)
    if min(before_s, after_s) < 2 * _ENDS_S:
        return None
    changes: list[tuple[float, float]] = []
    for start_s, end_s in (
        (segment.step_s - 0.5 * before_s, segment.step_s),  # what came before a segment has settled
        (segment.step_s + 0.5 * after_s, segment.step_s + after_s),
    ):
        first, last = (recording.rows_before(time_s) for time_s in (start_s, end_s))
        rows = recording.rows(first, last, ("time_s", _SHAFT, _WHEEL))
        known = np.isfinite(rows[_SHAFT]) & np.isfinite(rows[_WHEEL])
        if np.count_nonzero(known) < 3:
            return None
        slope = float(np.polyfit(rows["time_s"][known] - start_s, rows[_WHEEL][known], 1)[0])
        changes.append((_mean(rows[_SHAFT][known]), slope))
    torque, acceleration = (after - before for before, after in zip(*changes, strict=True))
    if abs(torque) < _LEAST_NM:
        return None
    if abs(acceleration) * after_s < _LEAST_RAD_S:
        return float("inf") if abs(torque) > _HEAVIEST_KG_M2 * _LEAST_RAD_S / after_s else None
    return float(torque / acceleration)


def _lag_s(recording: Recording, segment: Segment) -> float | None:
    """The lag of T_s behind T_m that two lengths of time agree on: a slow ripple gives each another."""
    lags = [_lag_within_s(recording, segment, share * _AFTER_S) for share in (0.5, 0.75, 1.0)]
    known = sorted((lag for lag in lags if lag is not None), key=abs, reverse=True)
    if len(known) < 2 or known[0] * known[1] < 0.0:
        return None
    return known[1]


def _lag_within_s(recording: Recording, segment: Segment, after_s: float) -> float | None:
    """The lag within a time after the step; None where the step is too short or too small to tell."""
    before_s = min(_ENDS_S, segment.step_s - segment.start_s)
    end_s = min(segment.end_s, segment.step_s + after_s)
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
    weight = hann(len(values))
    return float(weight @ values / np.sum(weight))
