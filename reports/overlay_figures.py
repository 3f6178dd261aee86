"""Runs of one plan laid over each other: responses at the step, their differences, spectra in the band."""

from __future__ import annotations

import numpy as np

from hil.analysis.comparison import ComparedRun, difference
from hil.core.channels import COMFORT_BAND_HZ
from hil.core.result import Segment
from reports import labels, style
from reports.channel_figures import DESCRIPTION, amplitude_spectrum, stretch_in_words
from reports.figure import Band, Figure, Trace
from reports.labels import Label, channel_label, channel_unit
from reports.slip_figures import slip_figure, slip_trace
from reports.step_figures import FIRST_SECONDS, SLOW_HZ, SPECTRUM_TO_HZ, SPECTRUM_WINDOW_S
from reports.stretch import cut, line

_ROLES = ("gain", "phase", "third", "fourth", "fifth", "reference")


def overlay(runs: tuple[ComparedRun, ...], segment: Segment) -> tuple[Figure, ...]:
    """A segment of every run: its first seconds, differences and spectra of a step, else the whole of it."""
    figures: list[Figure | None] = []
    if segment.kind == "step":
        figures = [
            _response(runs, segment.id, "shaft_torque_nm", "first", until_s=FIRST_SECONDS),
            _difference(runs, segment.id, "shaft_torque_nm"),
            _response(runs, segment.id, "motor_speed_rad_s", "first", until_s=FIRST_SECONDS),
            _spectrum(runs, segment.id, "motor_speed_rad_s"),
        ]
    else:
        figures = [_response(runs, segment.id, "shaft_torque_nm", "whole")]
    return tuple(figure for figure in figures if figure is not None)


def overlay_slip(
    runs: tuple[ComparedRun, ...], segment: Segment, channel: str, upper: float | None
) -> Figure | None:
    """Wheel slip of every run over the time from its own step, with the limit."""
    traces = []
    for index, run in enumerate(runs):
        own = _of(run, segment.id)
        if own is not None:
            traces.append(slip_trace(run.recording, own, channel, Label(run.name), *_role(index)))
    return slip_figure(traces, f"{segment.id}-slip", upper, segment.id)


def _of(run: ComparedRun, segment: str) -> Segment | None:
    return next((s for s in run.result.segments if s.id == segment), None)


def _role(index: int) -> tuple[str, str]:
    """Colour and dash of a run: one colour each, dashes once they have all been used."""
    return _ROLES[index % len(_ROLES)], style.DASHES[(index // len(_ROLES)) % len(style.DASHES)]


def _response(
    runs: tuple[ComparedRun, ...], segment: str, channel: str, suffix: str, until_s: float = np.inf
) -> Figure | None:
    """One channel of every run over the time from its own step."""
    traces = []
    for index, run in enumerate(runs):
        own = _of(run, segment)
        if own is None:
            continue
        role, dash = _role(index)
        start = max(own.start_s, own.step_s - 0.1) if np.isfinite(until_s) else own.start_s
        end = min(own.end_s, own.step_s + until_s)
        trace = line(
            run.recording,
            channel,
            Label(run.name),
            role,
            start_s=start,
            end_s=end,
            zero_s=own.step_s,
            dash=dash,
        )
        traces += [trace] if trace else []
    if not traces:
        return None
    label = channel_label(channel)
    tail = f", first {FIRST_SECONDS:g}{labels.THIN}s" if np.isfinite(until_s) else ""
    return Figure(
        f"{segment}-{channel}-{suffix}",
        Label(label.text, label.symbol, tail),
        "Time from the step",
        "s",
        label,
        channel_unit(channel),
        tuple(traces),
    )


def _difference(runs: tuple[ComparedRun, ...], segment: str, channel: str) -> Figure | None:
    """One channel of every further run minus the first one's; the smallest difference is drawn on top."""
    traces = []
    for index, run in enumerate(runs[1:], 1):
        found = difference(runs[0], run, segment, channel)
        if found is not None and np.isfinite(found[1]).any():
            traces.append(Trace(Label(run.name), *found, *_role(index)))
    if not traces:
        return None
    traces.sort(key=lambda trace: -float(np.nanstd(trace.y)))
    label = channel_label(channel)
    return Figure(
        f"{segment}-{channel}-difference",
        Label(label.text, label.symbol, f", difference from {runs[0].name}"),
        "Time from the step",
        "s",
        Label("Difference of", label.symbol),
        channel_unit(channel),
        tuple(traces),
    )


def _spectrum(runs: tuple[ComparedRun, ...], segment: str, channel: str) -> Figure | None:
    """Amplitude spectrum in the window of the band energy, of every run."""
    traces, lengths = [], []
    for index, run in enumerate(runs):
        own = _of(run, segment)
        if own is None:
            continue
        start, end = (own.step_s + offset for offset in SPECTRUM_WINDOW_S)
        found = cut(run.recording, channel, start, min(end, own.end_s))
        spectrum = amplitude_spectrum(*found) if found else None
        if spectrum is None:
            continue
        shown = spectrum.frequency_hz <= 2 * SPECTRUM_TO_HZ
        lengths.append(own.end_s - own.step_s)
        role, dash = _role(index)
        x, y = spectrum.frequency_hz[shown], spectrum.amplitude[shown]
        traces.append(Trace(Label(run.name), x, y, role, dash))
    if not traces:
        return None
    scale = max(float(t.y[t.x >= SLOW_HZ].max(initial=0.0)) for t in traces)
    label, band = channel_label(channel), COMFORT_BAND_HZ
    return Figure(
        f"{segment}-{channel}-spectrum",
        Label("Spectrum of motor speed", label.symbol),
        "Frequency",
        "Hz",
        Label("Amplitude of", label.symbol),
        channel_unit(channel),
        tuple(traces),
        bands=(Band(*band, f"{band[0]:g}{labels.DASH}{band[1]:g}{labels.THIN}Hz"),),
        x_range=(0.0, SPECTRUM_TO_HZ),
        y_range=(0.0, 1.2 * scale) if scale > 0 else None,
        caption=f"{DESCRIPTION}, Hann window, {stretch_in_words(SPECTRUM_WINDOW_S, lengths)}.",
    )
