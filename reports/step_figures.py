"""Step responses from one initial speed, the controllers overlaid (Figs. 13 to 16 of the paper)."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from hil.core.channels import COMFORT_BAND_HZ
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment
from reports import labels, style
from reports.channel_figures import DESCRIPTION, amplitude_spectrum, stretch_in_words
from reports.figure import Band, Figure, Level, Mark, Section, Trace, not_drawn
from reports.labels import Label, channel_label, channel_unit
from reports.members import Member, controller_of, members, road_in_words
from reports.stretch import cut, line

SPECTRUM_WINDOW_S = (4.0, 20.0)
FIRST_SECONDS = 2.0
SPECTRUM_TO_HZ = 30.0
SLOW_HZ = 2.0  # what is left of the run-up below this does not set the scale
_TIME = "Time from the step"
_MOTOR_SPEED = "motor_speed_rad_s"
_SHAFT_TORQUE = "shaft_torque_nm"

Criteria = dict[str, CriterionResult]


def _short(channel: str) -> str:
    """A channel as metrics name it: without its unit."""
    return re.sub(r"_(rad_s|m_s|nm)$", "", channel)


class _Plan(NamedTuple):
    title: str
    channel: str
    draw: Callable[[], Figure | None]


def step_section(recording: Recording, segments: list[Segment], criteria: Criteria) -> Section:
    """Figures of `segments`, all steps from one initial speed; `criteria` by id give peaks and limits."""
    speed = labels.nominal(segments[0].initial_speed_km_h, "km/h")
    section_id = f"steps-{segments[0].initial_speed_km_h:g}kmh"
    overlay = Overlay(recording, members(segments), criteria, section_id)
    plans = [
        _Plan("Motor speed", _MOTOR_SPEED, overlay.motor_speed),
        _Plan("Spectrum of motor speed", _MOTOR_SPEED, overlay.motor_speed_spectrum),
        _Plan("Shaft torque", _SHAFT_TORQUE, overlay.shaft_torque),
        _Plan("First seconds of shaft torque", _SHAFT_TORQUE, overlay.shaft_torque_enlarged),
        _Plan("Driving torque", "driving_torque_est_nm", overlay.driving_torque),
        _Plan("Torque request", "motor_torque_ref_nm", overlay.torque_request),
    ]
    drawn = [(plan, plan.draw()) for plan in plans]
    figures = [figure for _, figure in drawn if figure is not None]
    return Section(
        section_id,
        f"Steps from {speed}",
        _text(segments),
        tuple(figures),
        not_drawn(_missing(drawn)),
    )


def _missing(drawn: list[tuple[_Plan, Figure | None]]) -> list[Label]:
    """A channel without any figure by its own name; a single figure that lacks values by its title."""
    there = {plan.channel for plan, figure in drawn if figure is not None}
    return [
        Label(plan.title, channel_label(plan.channel).symbol)
        if plan.channel in there
        else channel_label(plan.channel)
        for plan, figure in drawn
        if figure is None
    ]


def _text(segments: list[Segment]) -> str:
    steps = dict.fromkeys((s.reference_before, s.reference_after) for s in segments)
    sizes = ", ".join(
        f"{labels.nominal(before)} to {labels.nominal(after, 'N m')}"
        for before, after in steps
        if before != after
    )
    roads = [road_in_words(segment) for segment in segments]
    named = zip(segments, roads, strict=True)
    names = ", ".join(f"{segment.id} ({road})" if road else segment.id for segment, road in named)
    drivers = dict.fromkeys(filter(None, map(controller_of, segments)))
    driven = f" Controller: {', '.join(drivers)}." if len(drivers) == 1 and len(segments) > 1 else ""
    return (
        f"Step of the driving torque reference: {sizes}. " if sizes else ""
    ) + f"Segments: {names}.{driven}"


class Overlay:
    """Figures of steps laid over each other; figure ids begin with `section_id`."""

    def __init__(
        self, recording: Recording, overlaid: list[Member], criteria: Criteria, section_id: str
    ) -> None:
        self._recording = recording
        self._members = overlaid
        self._criteria = criteria
        self._id = section_id

    def motor_speed(self) -> Figure | None:
        """ω_m over the time from the step."""
        return self.response("motor-speed", _MOTOR_SPEED)

    def torque_request(self) -> Figure | None:
        """T_m* over the time from the step."""
        return self.response("torque-request", "motor_torque_ref_nm")

    def shaft_torque(self) -> Figure | None:
        """T_s over the time from the step, the peaks that criteria judge marked."""
        figure = self.response("shaft-torque", _SHAFT_TORQUE, "peak_shaft_torque", "peak")
        return figure and self._with_peaks(figure)

    def shaft_torque_enlarged(self) -> Figure | None:
        """T_s of the first seconds, with its reference and the limits of the peak that are near."""
        figure = self.response("shaft-torque-enlarged", _SHAFT_TORQUE, until_s=FIRST_SECONDS)
        if figure is None:
            return None
        label = channel_label(_SHAFT_TORQUE)
        reference = self._reference(-0.1, FIRST_SECONDS)
        figure = replace(
            figure,
            title=Label(label.text, label.symbol, f", first {FIRST_SECONDS:g}{labels.THIN}s"),
            traces=(*figure.traces, *reference),
            levels=self._peak_limits(figure.traces),
            x_range=(-0.1, FIRST_SECONDS),
        )
        return self._with_peaks(figure)

    def _with_peaks(self, figure: Figure) -> Figure:
        """Where the criteria's peaks are, as far as the figure reaches."""
        last_s = figure.x_range[1] if figure.x_range else np.inf
        marks = [mark for mark in map(self._peak, self._members) if mark is not None and mark.x <= last_s]
        text = "; ".join(mark.label for mark in marks)
        return replace(figure, marks=tuple(marks), caption=f"○ {text}." if marks else figure.caption)

    def _peak(self, member: Member) -> Mark | None:
        """The largest sample from the step on, where a criterion asks for it."""
        segment = member.segment
        found = cut(self._recording, _SHAFT_TORQUE, segment.step_s, segment.end_s)
        if f"{segment.id}.peak_shaft_torque" not in self._criteria or found is None:
            return None
        at = int(np.nanargmax(found[1]))
        after_s, value = float(found[0][at] - segment.step_s), float(found[1][at])
        when = labels.quantity(after_s, "s", 3)
        label = f"{member.name}: peak {labels.quantity(value, 'N m', significant=4)} at {when}"
        return Mark(after_s, value, label, member.role)

    def driving_torque(self) -> Figure | None:
        """Reference and estimate of the driving torque."""
        estimate = channel_label("driving_torque_est_nm")
        figure = self.response("driving-torque", "driving_torque_est_nm")
        if figure is None:
            return None
        traces = (*figure.traces, *self._reference(-1.0, np.inf))
        title = Label("Driving torque, estimate", estimate.symbol, " and reference")
        return replace(figure, title=title, y_label=Label("Driving torque"), traces=traces)

    def motor_speed_spectrum(self) -> Figure | None:
        """Amplitudes of ω_m over frequency."""
        return self.spectrum(_MOTOR_SPEED)

    def spectrum(self, channel: str) -> Figure | None:
        """Amplitudes of a channel over frequency in the window of its band energy, the band shaded."""
        label = channel_label(channel)
        traces = [
            trace for member in self._members for trace in self._spectrum(member, channel) if trace.x.size
        ]
        if not traces:
            return None
        scale = max(float(t.y[t.x >= SLOW_HZ].max(initial=0.0)) for t in traces)
        lengths = [member.segment.end_s - member.segment.step_s for member in self._members]
        band = f"{COMFORT_BAND_HZ[0]:g}{labels.DASH}{COMFORT_BAND_HZ[1]:g}{labels.THIN}Hz"
        return Figure(
            id=f"{self._id}-{_short(channel).replace('_', '-')}-spectrum",
            title=Label(f"Spectrum of {label.text.lower()}", label.symbol),
            x_text="Frequency",
            x_unit="Hz",
            y_label=Label("Amplitude of", label.symbol),
            y_unit=channel_unit(channel),
            traces=tuple(traces),
            bands=(Band(*COMFORT_BAND_HZ, band),),
            x_range=(0.0, SPECTRUM_TO_HZ),
            y_range=(0.0, 1.2 * scale) if scale > 0 else None,
            caption=f"{DESCRIPTION}, Hann window, {stretch_in_words(SPECTRUM_WINDOW_S, lengths)}. "
            f"The scale is set by {SLOW_HZ:g}{labels.THIN}Hz and above.",
        )

    def _spectrum(self, member: Member, name: str) -> list[Trace]:
        segment = member.segment
        start, end = (segment.step_s + offset for offset in SPECTRUM_WINDOW_S)
        found = cut(self._recording, name, start, min(end, segment.end_s))
        spectrum = amplitude_spectrum(*found) if found else None
        if spectrum is None:
            return []
        shown = spectrum.frequency_hz <= 2 * SPECTRUM_TO_HZ
        label = self._named(member, f"band_energy_{_short(name)}", "band energy")
        frequency, amplitude = spectrum.frequency_hz[shown], spectrum.amplitude[shown]
        return [Trace(label, frequency, amplitude, member.role, member.dash)]

    def response(
        self, suffix: str, channel: str, metric: str = "", word: str = "", until_s: float = np.inf
    ) -> Figure | None:
        """One channel over the time from the step; `word` and the value of `metric` stand in the names."""
        traces = [
            self._line(channel, member, self._named(member, metric, word), until_s)
            for member in self._members
        ]
        drawn = tuple(trace for trace in traces if trace is not None)
        if not drawn:
            return None
        label = channel_label(channel)
        unit = channel_unit(channel)
        return Figure(f"{self._id}-{suffix}", label, _TIME, "s", label, unit, drawn)

    def _line(self, channel: str, member: Member, label: Label, until_s: float) -> Trace | None:
        segment = member.segment
        end = min(segment.end_s, segment.step_s + until_s)
        return line(
            self._recording,
            channel,
            label,
            member.role,
            start_s=segment.start_s,
            end_s=end,
            zero_s=segment.step_s,
            dash=member.dash,
        )

    def _named(self, member: Member, metric: str, word: str) -> Label:
        """The member's name and, where a criterion has it, its value: one number in table and figure."""
        criterion = self._criteria.get(f"{member.segment.id}.{metric}")
        if criterion is None or criterion.value is None:
            return Label(member.name)
        return Label(
            f"{member.name}, {word} {labels.quantity(criterion.value, criterion.unit, significant=3)}"
        )

    def _reference(self, from_s: float, until_s: float) -> list[Trace]:
        """The reference of the first member that has one; a second one only if it steps differently."""
        label = channel_label("driving_torque_ref_nm")
        seen: dict[tuple[float, float], Trace] = {}
        for member in self._members:
            s = member.segment
            key = (s.reference_before, s.reference_after)
            trace = line(
                self._recording,
                "driving_torque_ref_nm",
                Label("Reference", label.symbol),
                "reference",
                start_s=max(s.start_s, s.step_s + from_s),
                end_s=min(s.end_s, s.step_s + until_s),
                zero_s=s.step_s,
                dash=style.DASHES[1 + len(seen) % 3],
            )
            if trace is not None and key not in seen:
                seen[key] = trace
        if len(seen) == 1:
            return list(seen.values())
        steps = (f", {labels.nominal(a)} to {labels.nominal(b, 'N m')}" for a, b in seen)
        named = zip(seen.values(), steps, strict=True)
        return [replace(one, label=Label("Reference", label.symbol, step)) for one, step in named]

    def _peak_limits(self, traces: tuple[Trace, ...]) -> tuple[Level, ...]:
        """Limits of the peak, where they lie near enough to the lines not to flatten them."""
        highest = max(float(np.nanmax(trace.y)) for trace in traces)
        near: dict[float, list[str]] = {}
        for member in self._members:
            criterion = self._criteria.get(f"{member.segment.id}.peak_shaft_torque")
            if criterion and criterion.upper is not None and 0 < criterion.upper <= 1.8 * highest:
                near.setdefault(criterion.upper, []).append(member.name)
        return tuple(
            Level(upper, f"Limit {labels.nominal(upper, 'N m')}, {' and '.join(names)}")
            for upper, names in near.items()
        )
