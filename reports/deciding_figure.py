"""The picture of the criterion that decides a run: its response with the limit, its value marked."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from hil.core.channels import CHANNELS, TIME
from hil.core.recording import Recording
from hil.core.result import CriterionResult, RunResult, Segment
from reports import labels
from reports.figure import Figure, Level, Mark
from reports.labels import Label
from reports.members import members
from reports.slip_figures import deciding_slip, slip_channel
from reports.step_figures import FIRST_SECONDS, Overlay
from reports.stretch import cut

FIGURE_ID = "deciding"
_EXTREMES = {"peak": 1.0, "trough": -1.0}  # times the direction of the step
_FARTHEST = 3.0  # of the response's own height: a limit beyond it would flatten the response
_BEFORE_S = 0.1


def deciding_figure(recording: Recording, result: RunResult, criterion: CriterionResult) -> Figure | None:
    """The response that `criterion` judges, with its rival's if it has one; None without samples to draw."""
    by_id = {segment.id: segment for segment in result.segments}
    segment = by_id.get(criterion.id.partition(".")[0])
    slipping = slip_channel(criterion.definition)
    if segment is not None and slipping:
        slip = deciding_slip(recording, segment, criterion, slipping)
        return slip and replace(slip, id=FIGURE_ID)
    channel = next((name for name in _named(criterion) if name in recording), None)
    if segment is None or channel is None:
        return None
    shown = [segment, *([by_id[criterion.below]] if criterion.below in by_id else [])]
    alike = [s for s in result.segments if (s.kind, s.initial_speed_km_h) == _kind(segment)]
    known = {member.segment.id: member for member in members(list(dict.fromkeys([*alike, *shown])))}
    overlay = Overlay(recording, [known[s.id] for s in shown], {c.id: c for c in result.criteria}, "")
    if "band_energy" in criterion.id:
        figure = overlay.spectrum(channel)
    else:
        figure = overlay.response("", channel)
        figure = figure and _with_limit(figure, recording, channel, shown, criterion)
    if figure is None:
        return None
    if len(shown) == 1:  # dashes tell repeats of a controller from each other: here is one
        figure = replace(figure, traces=tuple(replace(trace, dash="solid") for trace in figure.traces))
    return replace(figure, id=FIGURE_ID)


def _kind(segment: Segment) -> tuple[str, float]:
    return segment.kind, segment.initial_speed_km_h


def _named(criterion: CriterionResult) -> list[str]:
    """Channels in the order in which the definition names them, by name or by symbol."""
    by_symbol = {channel.symbol: name for name, channel in CHANNELS.items()}
    words = re.split(r"[\s(),;:]+", criterion.definition.rstrip("."))
    names = (by_symbol.get(word, word) for word in words)
    return list(dict.fromkeys(name for name in names if name in CHANNELS and name != TIME))


def _with_limit(
    figure: Figure, recording: Recording, channel: str, shown: list[Segment], criterion: CriterionResult
) -> Figure:
    """Extremes marked, the limit as a line, the time axis as long as they need."""
    own = shown[0]
    downward = own.reference_after < own.reference_before
    metric = criterion.id.split(".")[1].partition("_")[0] if "." in criterion.id else ""
    turn = _EXTREMES.get(metric, 1.0) * (-1.0 if downward else 1.0)
    marks: tuple[Mark, ...] = ()
    if metric in (*_EXTREMES, "overshoot"):
        drawn = zip(shown, figure.traces, strict=False)
        found = (_extreme(recording, channel, s, turn, trace.label, trace.role) for s, trace in drawn)
        marks = tuple(mark for mark in found if mark is not None)
    early = bool(marks) and all(mark.x <= FIRST_SECONDS for mark in marks)
    return replace(
        figure,
        marks=marks,
        levels=_levels(figure, criterion, metric, own, downward=downward),
        x_range=(-_BEFORE_S, FIRST_SECONDS) if early else None,
    )


def _extreme(
    recording: Recording, channel: str, segment: Segment, turn: float, name: Label, role: str
) -> Mark | None:
    found = cut(recording, channel, segment.step_s, segment.end_s)
    if found is None:
        return None
    at = int(np.nanargmax(turn * found[1]))
    when_s, value = float(found[0][at] - segment.step_s), float(found[1][at])
    unit = CHANNELS[channel].unit
    label = f"{name.plain()}: {labels.quantity(value, unit)} at {labels.quantity(when_s, 's', 3)}"
    return Mark(when_s, value, label, role)


def _as_chosen(limit: float, unit: str) -> str:
    """A limit that somebody chose as written, another segment's value with four digits."""
    chosen = float(f"{limit:.6g}") == limit
    return labels.nominal(limit, unit) if chosen else labels.quantity(limit, unit)


def _levels(
    figure: Figure, criterion: CriterionResult, metric: str, segment: Segment, *, downward: bool
) -> tuple[Level, ...]:
    """Limits in the channel's own unit, near enough to leave the response its height."""
    limits = [limit for limit in (criterion.lower, criterion.upper) if limit is not None]
    if criterion.unit != figure.y_unit or metric not in (*_EXTREMES, "overshoot"):
        return ()
    where = {limit: limit for limit in limits}
    if metric == "overshoot":
        where = {limit: segment.reference_after + (-limit if downward else limit) for limit in limits}
    values = np.concatenate([trace.y[np.isfinite(trace.y)] for trace in figure.traces])
    low, high = float(values.min()), float(values.max())
    room = _FARTHEST * max(high - low, 1e-9)
    of = f" ({criterion.below})" if criterion.below else f", {segment.id}"
    above = "reference + " if metric == "overshoot" else ""
    return tuple(
        Level(at, f"Limit {above}{_as_chosen(limit, criterion.unit)}{of}")
        for limit, at in where.items()
        if low - room < at < high + room
    )
