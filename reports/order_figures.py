"""Spectra over the wheel's speed (waterfall), and amplitudes of its orders.

A resonance stands at one frequency whatever the speed; an order of the wheel moves with it. Orders are
followed along the wheel's angle (Fyfe and Munck, Analysis of computed order tracking, MSSP 11(2), 1997).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from hil.core.recording import Recording
from hil.core.result import Segment
from reports import labels
from reports.channel_figures import amplitude_spectrum
from reports.figure import Figure, Section, Trace
from reports.labels import Label, channel_label, channel_unit
from reports.stretch import cut

Array = npt.NDArray[np.float64]

STRETCH_S = 1.0  # of which a spectrum is taken; the next begins half of it later
TO_HZ = 30.0
_MOST_SEGMENTS, _MOST_SPECTRA = 4, 16
_LEAST_SPAN_RAD_S = 3.0  # by which the wheel's speed has to differ
_LEAST_TURNS = 2.0  # of an order in a stretch
_HEIGHT = 2.5  # of the largest amplitude, in distances of the spectra
_LOW_HZ = 2.0  # what moves slower is the run-up itself
_CHANNEL, _WHEEL = "shaft_torque_nm", "wheel_speed_rad_s"
_ROLES = ("gain", "third", "fourth", "reference")
_TEXT = (
    "Segments in which the wheel's speed changes. Spectra of stretches of a second stand at the height of "
    "their mean speed: a resonance stays where it is, an order of the wheel moves along its dashed line."
)


class _Stretch(NamedTuple):
    """Times in s, values and wheel speeds (rad/s) of a second, 1-D of one length."""

    time: Array
    values: Array
    speed: Array

    @property
    def mean_rad_s(self) -> float:
        return float(np.mean(self.speed))


def order_section(recording: Recording, segments: Iterable[Segment]) -> Section | None:
    """A waterfall and the tracked orders of each segment that runs through speeds; None if none does.

    Only of benches that declare what turns with the wheel: on others they would make every report longer.
    """
    figures: list[Figure] = []
    for segment in (one for one in segments if one.wheel_orders):
        stretches = _stretches(recording, segment)
        if len(figures) < 2 * _MOST_SEGMENTS and stretches:
            found = (waterfall(segment, stretches), tracked_orders(segment, stretches))
            figures += [figure for figure in found if figure is not None]
    if not figures:
        return None
    return Section("orders", "Spectra over speed, and orders of the wheel", _TEXT, tuple(figures))


def waterfall(segment: Segment, stretches: list[_Stretch]) -> Figure | None:
    """Spectra one above the other, at the height of the wheel's speed, with the lines of declared orders."""
    spectra = []
    for stretch in _spread(stretches):
        spectrum = amplitude_spectrum(stretch.time, stretch.values)
        if spectrum is not None:
            shown = spectrum.frequency_hz <= TO_HZ
            spectra.append((stretch.mean_rad_s, spectrum.frequency_hz[shown], spectrum.amplitude[shown]))
    largest = max((float(a[f >= _LOW_HZ].max(initial=0.0)) for _, f, a in spectra), default=0.0)
    if largest <= 0.0:
        return None
    speeds = [speed for speed, _, _ in spectra]
    unit_rad_s = _HEIGHT * (max(speeds) - min(speeds)) / max(1, len(speeds) - 1)
    gap = np.array([np.nan])
    x = np.concatenate([part for _, frequency, _ in spectra for part in (frequency, gap)])[:-1]
    heights = [speed + unit_rad_s / largest * np.where(f < _LOW_HZ, 0.0, a) for speed, f, a in spectra]
    y = np.concatenate([part for height in heights for part in (height, gap)])[:-1]
    label = channel_label(_CHANNEL)
    traces = [Trace(Label("Amplitude of", label.symbol), x, y, "phase")]
    for role, order in zip(_ROLES, segment.wheel_orders, strict=False):
        ends = np.array([min(speeds), max(speeds)])
        traces.append(Trace(Label(f"order {order:g}"), order * ends / (2 * np.pi), ends, role, "dash"))
    height = labels.quantity(largest, channel_unit(_CHANNEL), significant=3)
    return Figure(
        id=f"waterfall-{segment.id}",
        title=Label(f"{segment.id}: spectra over speed of {label.text.lower()}", label.symbol),
        x_text="Frequency",
        x_unit="Hz",
        y_label=channel_label(_WHEEL),
        y_unit=channel_unit(_WHEEL),
        traces=tuple(traces),
        x_range=(0.0, TO_HZ),
        caption=f"Hann windows of {STRETCH_S:g}{labels.THIN}s, from {_LOW_HZ:g}{labels.THIN}Hz on; "
        f"the highest peak is {height}.",
    )


def tracked_orders(segment: Segment, stretches: list[_Stretch]) -> Figure | None:
    """Amplitude of each declared order over the wheel's speed; None where none turns often enough."""
    traces = []
    for role, order in zip(_ROLES, segment.wheel_orders, strict=False):
        points = [
            (stretch.mean_rad_s, order_amplitude(stretch.time, stretch.values, stretch.speed, order))
            for stretch in stretches
            if order * abs(stretch.mean_rad_s) * STRETCH_S >= 2 * np.pi * _LEAST_TURNS
        ]
        if len(points) > 1:
            x, y = np.array(sorted(points)).T
            traces.append(Trace(Label(f"order {order:g}"), x, y, role))
    if not traces:
        return None
    label = channel_label(_CHANNEL)
    return Figure(
        id=f"orders-{segment.id}",
        title=Label(f"{segment.id}: orders of {label.text.lower()}", label.symbol),
        x_text=channel_label(_WHEEL).text,
        x_unit=channel_unit(_WHEEL),
        y_label=Label("Amplitude of", label.symbol),
        y_unit=channel_unit(_CHANNEL),
        traces=tuple(traces),
        caption=f"Least squares along the wheel's angle in stretches of {STRETCH_S:g}{labels.THIN}s.",
    )


def order_amplitude(time_s: Array, values: Array, speed_rad_s: Array, order: float) -> float:
    """Amplitude of what turns `order` times a turn of the wheel in a stretch, beside a parabola.

    Args:
        time_s, values, speed_rad_s: 1-D, of one length; the wheel's angle is the integral of its speed.
    """
    steps = 0.5 * np.diff(time_s) * (speed_rad_s[1:] + speed_rad_s[:-1])
    angle = order * np.concatenate([[0.0], np.cumsum(steps)])
    late = (time_s - time_s.mean()) / (time_s[-1] - time_s[0])
    weight = np.sqrt(np.hanning(len(time_s) + 2)[1:-1])
    columns = np.stack([np.ones_like(late), late, late**2, np.cos(angle), np.sin(angle)], axis=1)
    found = np.linalg.lstsq(columns * weight[:, None], values * weight, rcond=None)[0]
    return float(np.hypot(found[3], found[4]))


def _stretches(recording: Recording, segment: Segment) -> list[_Stretch]:
    """Seconds from the step on, half over each other; empty where the speed changes too little."""
    values, speed = (cut(recording, name, segment.step_s, segment.end_s) for name in (_CHANNEL, _WHEEL))
    if values is None or speed is None or segment.end_s - segment.step_s < 2 * STRETCH_S:
        return []
    known = np.isfinite(values[1]) & np.isfinite(speed[1])
    time, torque, turns = values[0][known], values[1][known], speed[1][known]
    found = []
    for start_s in np.arange(segment.step_s, segment.end_s - STRETCH_S, 0.5 * STRETCH_S):
        first, last = np.searchsorted(time, (start_s, start_s + STRETCH_S))
        if last - first > 2 * TO_HZ * STRETCH_S:
            found.append(_Stretch(time[first:last], torque[first:last], turns[first:last]))
    means = [stretch.mean_rad_s for stretch in found]
    return found if means and max(means) - min(means) >= _LEAST_SPAN_RAD_S else []


def _spread(stretches: list[_Stretch]) -> list[_Stretch]:
    """As many as can be distinguished, evenly over the speeds."""
    ordered = sorted(stretches, key=lambda one: one.mean_rad_s)
    if len(ordered) <= _MOST_SPECTRA:
        return ordered
    speeds = np.array([one.mean_rad_s for one in ordered])
    wanted = np.linspace(speeds[0], speeds[-1], _MOST_SPECTRA)
    places = dict.fromkeys(int(np.argmin(np.abs(speeds - one))) for one in wanted)
    return [ordered[place] for place in places]
