"""Plain figures of channels over time and as amplitude spectra: sweeps, whole runs, foreign recordings.

A sine of amplitude A on a frequency line reads A.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hil.core.channels import CHANNELS, INPUT, OUTPUTS, TIME
from hil.core.recording import Recording
from hil.core.result import Segment
from reports import labels
from reports.figure import Band, Figure, Section, Trace, not_drawn
from reports.labels import THIN, Label, channel_label, channel_unit
from reports.members import controller_of
from reports.stretch import Array, Lines, cut, line

DESCRIPTION = "Single-sided amplitude spectrum, linear trend removed"
_LEAST_SAMPLES = 16
_LARGEST_MISSING_SHARE = 0.05


@dataclass(frozen=True)
class Spectrum:
    """Amplitudes (unit of the channel) over frequencies (Hz), both 1-D of one length, without 0 Hz."""

    frequency_hz: Array
    amplitude: Array

    @property
    def resolution_hz(self) -> float:
        """Distance of the frequency lines."""
        return float(self.frequency_hz[0])


def stretch_in_words(window_s: tuple[float, float], lengths_s: Iterable[float]) -> str:
    """What of a window after the step the spectra of stretches show that end so long after their steps."""
    start, end = window_s
    ends = sorted({f"{min(end, round(length, 3)):g}" for length in lengths_s}, key=float)
    return f"{start:g} to {' or '.join(ends)}{THIN}s after the step"


def amplitude_spectrum(time_s: Array, values: Array, *, hann: bool = True) -> Spectrum | None:
    """Spectrum of `values` at `time_s` (1-D, same length); uneven samples are put on an even grid first.

    `hann` suits steady parts of a signal; sweeps, which begin and end at rest, are taken without a window.
    None if there are fewer than 16 samples or more than 5 % of them are missing.
    """
    finite = np.isfinite(values) & np.isfinite(time_s)
    if finite.sum() < _LEAST_SAMPLES or np.mean(~finite) > _LARGEST_MISSING_SHARE:
        return None
    time_s, values = time_s[finite], values[finite]
    span = float(time_s[-1] - time_s[0])
    step = float(np.median(np.diff(time_s)))
    if not (span > 0 and step > 0):
        return None
    count = round(span / step) + 1
    if count < _LEAST_SAMPLES or count > 4 * len(values):
        return None
    grid = np.linspace(time_s[0], time_s[-1], count)
    even = np.interp(grid, time_s, values)
    centred = grid - grid.mean()
    even = even - even.mean() - centred * (centred @ even) / (centred @ centred)
    turn = 2 * np.pi * np.arange(count) / count
    window = 0.5 - 0.5 * np.cos(turn) if hann else np.ones(count)
    amplitude: Array = np.abs(np.fft.rfft(even * window)) * (2 / window.sum())
    frequency = np.arange(len(amplitude)) * (count - 1) / (count * span)
    return Spectrum(frequency[1:], amplitude[1:])


_ROLES = ("gain", "phase", "third", "fourth")
#: Channels that share axes.
_PANELS: tuple[tuple[str, ...], ...] = (
    ("motor_torque_ref_nm", "motor_torque_nm"),
    ("motor_speed_rad_s",),
    ("wheel_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s"),
    ("shaft_torque_nm", "shaft_torque_left_nm", "shaft_torque_right_nm"),
    ("vehicle_speed_m_s",),
    ("driving_torque_ref_nm", "driving_torque_est_nm"),
    ("dyno_torque_ref_nm",),
)
_OF_SIDES = ("dyno_torque_left_nm", "dyno_torque_right_nm")  # their sum is a channel
_MOST_UNKNOWN_CHANNELS = 12
_SPECTRUM_TO_HZ = 100.0


@dataclass(frozen=True)
class _Stretch:
    """Where figures are cut from, and how their ids begin; `thin`: channels drawn from fewer samples."""

    recording: Recording
    id: str
    start_s: float
    end_s: float
    thin: Lines = field(default_factory=dict)

    def line(self, name: str, role: str) -> Trace | None:
        """The channel over time; None if there is nothing to draw."""
        label = channel_label(name)
        if name not in self.thin:
            return line(self.recording, name, label, role, start_s=self.start_s, end_s=self.end_s)
        time, values = self.thin[name]
        return Trace(label, time, values, role) if np.isfinite(values).sum() > 1 else None


def sweep_section(recording: Recording, segment: Segment) -> Section:
    """Input and outputs of a segment that is no step, over time and as spectra."""
    where = _Stretch(recording, f"segment-{segment.id}", segment.start_s, segment.end_s)
    names = (INPUT, *OUTPUTS)
    over_time = [_time_figure(where, (name,)) for name in names]
    spectra = [_spectrum_figure(where, name, hann=False) for name in names]
    missing = [channel_label(n) for n, figure in zip(names, over_time, strict=True) if figure is None]
    controller = f", {controller_of(segment).lower()}" if segment.controller else ""
    start, end = (round(time_s, 3) for time_s in (segment.start_s, segment.end_s))
    when = f"{labels.nominal(start)} to {labels.nominal(end, 's')} of the recording"
    text = f"{segment.kind.capitalize()}{controller}, {when}."
    return Section(
        where.id,
        f"Segment {segment.id}",
        text,
        tuple(figure for figure in (*over_time, *spectra) if figure is not None),
        not_drawn(missing),
    )


def overview_section(recording: Recording, thin: Lines, segments: Sequence[Segment]) -> Section | None:
    """Torque request, speed and shaft torque of the whole run, its segments shaded; None without any."""
    where = _whole(recording, thin, "overview")
    if where is None:
        return None
    bands = _bands(where, segments)
    names = (INPUT, *(name for name in OUTPUTS if name != "wheel_speed_rad_s"))
    drawn = [_time_figure(where, (name,), bands) for name in names]
    figures = tuple(replace(figure, wide=True) for figure in drawn if figure is not None)
    return Section("overview", "The whole run", "", figures) if figures else None


def further_section(recording: Recording, thin: Lines, segments: Sequence[Segment]) -> Section | None:
    """What devices of their own have measured in the whole run, on its time; None without any."""
    where = _whole(recording, thin, "further")
    if where is None:
        return None
    names = [name for name in recording.channels if name not in CHANNELS and name not in _OF_SIDES]
    drawn = [_time_figure(where, (name,), _bands(where, segments)) for name in names[:_MOST_UNKNOWN_CHANNELS]]
    figures = tuple(figure for figure in drawn if figure is not None)
    left_out = len(names) - _MOST_UNKNOWN_CHANNELS
    notes = (f"{left_out} further channels are in the recording only.",) if left_out > 0 else ()
    return Section("further", "Further channels", "", figures, notes) if figures else None


def channels_section(recording: Recording, thin: Lines) -> Section:
    """Every channel over the whole recording, and spectra of the input and the outputs."""
    where = _whole(recording, thin, "channels")
    if where is None:
        return Section("channels", "Channels", "The recording has no samples to draw.", ())
    unknown = [name for name in recording.channels if name not in CHANNELS]
    drawn = unknown[:_MOST_UNKNOWN_CHANNELS]
    panels = [*_PANELS, *((name,) for name in drawn)]
    figures = [_time_figure(where, panel) for panel in panels]
    figures += _whole_spectra(where)
    left_out = len(unknown) - len(drawn)
    notes = (f"{left_out} further channels are in the table only.",) if left_out > 0 else ()
    return Section("channels", "Channels", "", tuple(f for f in figures if f is not None), notes)


def _bands(where: _Stretch, segments: Sequence[Segment]) -> tuple[Band, ...]:
    """Segments as shades behind a figure of the whole recording."""
    clipped = [(max(s.start_s, where.start_s), min(s.end_s, where.end_s), s.id) for s in segments]
    return tuple(Band(start, end, label) for start, end, label in clipped if end > start)


def _whole(recording: Recording, thin: Lines, section_id: str) -> _Stretch | None:
    if TIME not in recording or recording.samples < 2:
        return None
    return _Stretch(recording, section_id, recording.first_s, recording.last_s, thin)


def _time_figure(where: _Stretch, names: Sequence[str], bands: tuple[Band, ...] = ()) -> Figure | None:
    traces = [where.line(name, role) for name, role in zip(names, _ROLES, strict=False)]
    drawn = tuple(trace for trace in traces if trace is not None)
    if not drawn:
        return None
    label = drawn[0].label if len(drawn) == 1 else Label(channel_label(names[0]).text.split(",")[0])
    title = Label(" and ".join(t.label.plain() for t in drawn)) if len(drawn) == 2 else label
    return Figure(
        id=f"{where.id}-{names[0]}",
        title=title,
        x_text="Time",
        x_unit="s",
        y_label=label,
        y_unit=channel_unit(names[0], where.recording.metadata.get("units")),
        traces=drawn,
        bands=bands,
    )


def _whole_spectra(where: _Stretch) -> list[Figure | None]:
    """Of input and outputs; a long recording is read in one pass, and not in one for each of them."""
    recording = where.recording
    names = [name for name in (INPUT, *OUTPUTS) if name in recording]
    time_s: Array | None = None
    figures = []
    for name, values in recording.columns([TIME, *names]):
        if name == TIME:
            time_s = values
        elif time_s is not None and np.isfinite(values).sum() > 1:
            figures.append(_spectrum(where, name, (time_s, values), hann=True))
    return figures


def _spectrum_figure(where: _Stretch, name: str, *, hann: bool = True) -> Figure | None:
    return _spectrum(where, name, cut(where.recording, name, where.start_s, where.end_s), hann=hann)


def _spectrum(where: _Stretch, name: str, found: tuple[Array, Array] | None, *, hann: bool) -> Figure | None:
    spectrum = amplitude_spectrum(*found, hann=hann) if found else None
    if spectrum is None or not np.any(spectrum.amplitude > 0):
        return None
    label = channel_label(name)
    top = float(spectrum.amplitude.max())
    first, last = float(spectrum.frequency_hz[0]), float(spectrum.frequency_hz[-1])
    return Figure(
        id=f"{where.id}-{name}-spectrum",
        title=Label(f"Spectrum: {label.text.lower()}", label.symbol),
        x_text="Frequency",
        x_unit="Hz",
        y_label=Label("Amplitude of", label.symbol) if label.symbol else Label("Amplitude"),
        y_unit=channel_unit(name),
        traces=(Trace(label, spectrum.frequency_hz, spectrum.amplitude, _ROLES[0]),),
        x_range=(first, max(min(last, _SPECTRUM_TO_HZ), 2 * first)),
        y_range=(top * 1e-4, top * 2),
        logarithmic=True,
        caption=f"{DESCRIPTION}, {'Hann window' if hann else 'no window'}; frequency lines "
        f"{labels.quantity(spectrum.resolution_hz, 'Hz', significant=2)} apart.",
    )
