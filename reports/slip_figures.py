"""Wheel slip over time, r ω_l - V̂, with what it may be: of one run, and of several laid over each other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from hil.core.channels import CHANNELS
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment
from reports import labels
from reports.figure import Figure, Level, Mark, Trace
from reports.labels import Label
from reports.members import road_in_words
from reports.stretch import break_at_gaps, cut
from test_plans.metrics import WheelSlip

_VEHICLE, _UNIT = "vehicle_speed_m_s", "m/s"
_WHEELS = ("wheel_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s")
_BEFORE_S = 0.1


def slip_channel(definition: str) -> str:
    """The wheel whose slip a criterion's definition speaks of; '' where it speaks of none."""
    begins = {name: WheelSlip(channel=name).definition.partition(",")[0] for name in _WHEELS}
    return next((name for name, begin in begins.items() if definition.startswith(begin)), "")


def slip_trace(
    recording: Recording, segment: Segment, channel: str, label: Label, role: str, dash: str = "solid"
) -> Trace | None:
    """r ω_l - V̂ in m/s over the time from the step; None without radius or samples."""
    start_s = max(segment.start_s, segment.changes_from_s - _BEFORE_S)
    wheel = cut(recording, channel, start_s, segment.end_s)
    vehicle = cut(recording, _VEHICLE, start_s, segment.end_s)
    if wheel is None or vehicle is None or segment.rolling_radius_m is None:
        return None
    slip = segment.rolling_radius_m * wheel[1] - vehicle[1]
    return Trace(label, *break_at_gaps(wheel[0] - segment.step_s, slip), role, dash)


def slip_figure(traces: Iterable[Trace | None], id_: str, upper: float | None, of: str) -> Figure | None:
    """Traces of slip with the limit on either side; None without a trace. `of`: the segment's id."""
    drawn = tuple(trace for trace in traces if trace is not None)
    if not drawn:
        return None
    limit = "" if upper is None else f"Limit ±{labels.nominal(upper, _UNIT)}, {of}"
    levels = () if upper is None else (Level(upper, limit), Level(-upper, ""))
    title = Label("Wheel slip")
    return Figure(id_, title, "Time from the step", "s", title, _UNIT, drawn, levels=levels)


def deciding_slip(
    recording: Recording, segment: Segment, criterion: CriterionResult, channel: str
) -> Figure | None:
    """The slip that a criterion judges, its largest value marked with both speeds."""
    symbol = CHANNELS[channel].symbol
    trace = slip_trace(recording, segment, channel, Label("Wheel slip,", f"r {symbol}", " - V̂"), "phase")
    figure = slip_figure((trace,), "deciding-slip", criterion.upper, segment.id)
    if figure is None or trace is None:
        return None
    after = np.where((trace.x >= 0) & np.isfinite(trace.y), np.abs(trace.y), -1.0)
    at = int(np.argmax(after))
    vehicle = cut(recording, _VEHICLE, segment.start_s, segment.end_s)
    when_s, value = float(trace.x[at]), float(trace.y[at])
    speed = float("nan") if vehicle is None else float(np.interp(segment.step_s + when_s, *vehicle))
    words = (
        f"{labels.quantity(value, _UNIT, significant=3)} at {labels.quantity(when_s, 's', 2)}: wheel "
        f"{labels.quantity(speed + value, _UNIT, significant=4)}, "
        f"vehicle {labels.quantity(speed, _UNIT, significant=4)}"
    )
    road = road_in_words(segment)
    caption = f"○ {words}." + (f" {road[0].upper()}{road[1:]}." if road else "")
    return replace(figure, marks=(Mark(when_s, value, words, "phase"),), caption=caption)
