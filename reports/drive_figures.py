"""Tip-in and tip-out side by side: T_s of the first moments, with play, contact and jerk marked."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Literal

import numpy as np

from hil.core.errors import HilError
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment
from reports import labels
from reports.figure import Band, Figure, Mark, Section, Trace, not_drawn
from reports.labels import Label, channel_label, channel_unit
from reports.stretch import cut, line
from test_plans.metrics import Clunk, ContactEnergy, Jerk, NoValueError, TimeInPlay

#: Criteria that ask how a drive feels; a plan with one of these gets the section.
ASKS = ("jerk", "time_in_play", "play_crossings", "clunk", "contact_energy", "vibration_dose", "trough")
FROM_S, TO_S = -0.1, 0.8
_SHAFT_TORQUE, _REQUEST = "shaft_torque_nm", "driving_torque_ref_nm"
_MOST_PAIRS, _MOST_CONTACTS = 20, 3
_TEXT = (
    "Torque upwards on the left, downwards on the right, from the same speed. Shaded: no firm contact of the "
    "gears' flanks, less than 10 % of the step. ○ firm contacts, with the largest rate of T_s and "
    "energy of them, and the vehicle's largest jerk (25 Hz)."
)

Criteria = dict[str, CriterionResult]


def drive_section(recording: Recording, segments: Iterable[Segment], criteria: Criteria) -> Section | None:
    """Pairs of an upward and a downward step; None if no criterion asks how a drive feels."""
    asked = {name.rsplit(".", 1)[0] for name in criteria if name.rsplit(".", 1)[-1] in ASKS}
    wanted = [one for one in segments if one.id in asked and one.quantity == "driving_torque"]
    drawn, missing = [], []
    for segment in _paired(wanted)[: 2 * _MOST_PAIRS]:
        figure = drive_figure(recording, segment, criteria)
        if figure is None:
            missing.append(Label(segment.id))
        else:
            drawn.append(figure)
    if not drawn:
        return None
    return Section("drive", "Tip-in and tip-out", _TEXT, tuple(drawn), not_drawn(missing))


def drive_figure(recording: Recording, segment: Segment, criteria: Criteria | None = None) -> Figure | None:
    """T_s and its reference around one step; None where T_s has no values.

    Args:
        criteria: whose values stand in the marks, where a criterion of the segment has them.
    """
    known = criteria or {}
    label = channel_label(_SHAFT_TORQUE)
    end_s = min(segment.end_s, segment.step_s + TO_S)
    start_s = max(segment.start_s, segment.changes_from_s + FROM_S)

    def drawn(channel: str, name: Label, role: str, dash: str) -> Trace | None:
        ends = {"start_s": start_s, "end_s": end_s, "zero_s": segment.step_s}
        return line(recording, channel, name, role, dash=dash, **ends)

    torque = drawn(_SHAFT_TORQUE, Label("Shaft torque", label.symbol), "phase", "solid")
    if torque is None:
        return None
    reference = drawn(_REQUEST, Label("Reference"), "reference", "dash")
    bands, marks = _play(recording, segment, known)
    jerk = _jerk(recording, segment, torque, known)
    marks += [jerk] if jerk is not None else []
    return Figure(
        id=f"drive-{segment.id}",
        title=Label(segment.id),
        x_text="Time from the step",
        x_unit="s",
        y_label=label,
        y_unit=channel_unit(_SHAFT_TORQUE),
        traces=(torque, *([reference] if reference is not None else [])),
        bands=tuple(bands),
        marks=tuple(marks),
        x_range=(segment.changes_from_s - segment.step_s + FROM_S, TO_S),
        caption=f"○ {'; '.join(mark.label for mark in marks)}." if marks else "",
    )


def _paired(segments: list[Segment]) -> list[Segment]:
    """Upward, downward, upward, …, by initial speed; what has no counterpart comes at the end."""
    pairs: list[Segment] = []
    alone: list[Segment] = []
    for speed in dict.fromkeys(one.initial_speed_km_h for one in segments):
        here = [one for one in segments if one.initial_speed_km_h == speed]
        up = [one for one in here if one.reference_after > one.reference_before]
        down = [one for one in here if one.reference_after < one.reference_before]
        pairs += [one for pair in zip(up, down, strict=False) for one in pair]
        both = min(len(up), len(down))
        alone += [*up[both:], *down[both:]]
    return [*pairs, *alone]


def _play(recording: Recording, segment: Segment, criteria: Criteria) -> tuple[list[Band], list[Mark]]:
    """Passages through the play as bands, and where each ends as a mark with the rate that follows."""
    try:
        found = TimeInPlay(since="first_change").contacts(recording, segment)
    except (NoValueError, HilError):
        return [], []
    bands: list[Band] = []
    marks: list[Mark] = []
    for one in found[:_MOST_CONTACTS]:
        at_s = one.contact_s - segment.step_s
        if at_s > TO_S:
            continue
        if one.left_s is not None:
            length = labels.quantity(1000 * (one.contact_s - one.left_s), "ms", significant=3)
            bands.append(Band(one.left_s - segment.step_s, at_s, length))
        words = "contact" if marks else _contact(recording, segment, criteria)
        marks.append(Mark(at_s, _value(recording, one.contact_s), words, "fourth"))
    longest = max(bands, key=lambda band: band.end - band.start, default=None)
    return [band if band is longest else replace(band, label="") for band in bands], marks


def _contact(recording: Recording, segment: Segment, criteria: Criteria) -> str:
    """The figures of all contacts, which stand at the first."""
    try:
        rate = _judged(criteria, segment, Clunk.name)
        rate = Clunk(since="first_change").compute(recording, segment) if rate is None else rate
        text = f"contact, clunk {labels.quantity(rate, 'N m/s', significant=3)}"
    except (NoValueError, HilError):
        return "contact"
    try:
        energy = _judged(criteria, segment, ContactEnergy.name)
        energy = ContactEnergy(since="first_change").compute(recording, segment) if energy is None else energy
    except (NoValueError, HilError):
        return text
    return f"{text}, {labels.quantity(energy, 'J', significant=3)}"


def _jerk(recording: Recording, segment: Segment, torque: Trace, criteria: Criteria) -> Mark | None:
    try:
        after_s, value = Jerk(since=_since(criteria, segment)).largest(recording, segment)
    except (NoValueError, HilError):
        return None
    if after_s > TO_S:
        return None
    judged = _judged(criteria, segment, Jerk.name)
    shown = abs(value) if judged is None else judged
    words = f"largest jerk {labels.quantity(shown, 'm/s³', significant=3)}"
    return Mark(after_s, float(np.interp(after_s, torque.x, torque.y)), words, "third")


def _since(criteria: Criteria, segment: Segment) -> Literal["step", "first_change"]:
    """Where a criterion's jerk is looked for: the mark stands at the value that it judges."""
    criterion = criteria.get(f"{segment.id}.{Jerk.name}")
    whole = criterion is None or Jerk(since="first_change").window in criterion.definition
    return "first_change" if whole else "step"


def _judged(criteria: Criteria, segment: Segment, metric: str) -> float | None:
    """A criterion's value: one number in table and figure."""
    criterion = criteria.get(f"{segment.id}.{metric}")
    return None if criterion is None else criterion.value


def _value(recording: Recording, at_s: float) -> float:
    """T_s between samples."""
    found = cut(recording, _SHAFT_TORQUE, at_s - 0.01, at_s + 0.01)
    return float("nan") if found is None else float(np.interp(at_s, *found))
