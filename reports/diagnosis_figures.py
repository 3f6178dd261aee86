"""Figures of a diagnosis: one recording, measured and simulated before and after, in time and frequency."""

from __future__ import annotations

import numpy as np

from hil.analysis.diagnosis import Diagnosis, Overlay
from hil.analysis.power_density import power_density
from hil.core.channels import CHANNELS, OUTPUTS
from reports.figure import Figure, Trace
from reports.labels import Label, channel_label

WINDOW_S = 1.5


def shown_overlay(found: Diagnosis) -> Overlay:
    """The recording on which the new model differs most from the old one."""
    return max(found.overlays, key=_change)


def overlay_figures(overlay: Overlay) -> tuple[Figure, ...]:
    """Of each measured channel: `WINDOW_S` at the worst moment, the residual there, and its spectrum."""
    figures = []
    for column, channel in enumerate(OUTPUTS):
        if np.isfinite(overlay.measured[0, column]):
            figures += [draw(overlay, column, channel) for draw in (_in_time, _residual, _in_frequency)]
    return tuple(figures)


def _change(overlay: Overlay) -> float:
    """Mean square of what the new model changes, over the spread of the channel that it changes most."""
    has = np.isfinite(overlay.measured[0])
    change = np.mean((overlay.after - overlay.before)[:, has] ** 2, axis=0)
    return float(np.max(change / (np.var(overlay.measured[:, has], axis=0) + 1e-12), initial=0.0))


def _worst(o: Overlay, column: int) -> slice:
    """The `WINDOW_S` in which the old model was worst."""
    size = min(max(10, round(WINDOW_S / o.dt)), len(o.measured))
    power = np.convolve((o.measured[:, column] - o.before[:, column]) ** 2, np.ones(size), "valid")
    first = int(np.argmax(power))
    return slice(first, first + size)


def _in_time(o: Overlay, column: int, channel: str) -> Figure:
    window = _worst(o, column)
    t = np.asarray(np.arange(window.start, window.stop) * o.dt, dtype=float)
    traces = (
        Trace(Label("model after"), t, o.after[window, column], "gain", width=2.2),
        Trace(Label("model before"), t, o.before[window, column], "phase", "dash"),
        Trace(Label("measured"), t, o.measured[window, column], "measured", width=0.9),
    )
    unit = CHANNELS[channel].unit
    label = channel_label(channel)
    return Figure(f"time-{channel}", Label(label.text), "Time", "s", label, unit, traces, wide=True)


def _residual(o: Overlay, column: int, channel: str) -> Figure:
    """What is left of the measurement, in the same window."""
    window = _worst(o, column)
    t = np.asarray(np.arange(window.start, window.stop) * o.dt, dtype=float)
    measured = o.measured[window, column]
    traces = (
        Trace(Label("residual before"), t, measured - o.before[window, column], "phase"),
        Trace(Label("residual after"), t, measured - o.after[window, column], "gain"),
    )
    title = Label(f"{channel_label(channel).text}, measured minus simulated")
    unit = CHANNELS[channel].unit
    return Figure(f"residual-{channel}", title, "Time", "s", Label("residual"), unit, traces)


def _in_frequency(o: Overlay, column: int, channel: str) -> Figure:
    traces = []
    for name, simulated, role in (("error before", o.before, "phase"), ("error after", o.after, "gain")):
        error = o.measured[:, column] - simulated[:, column]
        f, density = power_density(error[:, None], o.dt, min(4096, len(error)))
        inside = (f > 0.2) & (f < 100.0)
        traces.append(Trace(Label(name), f[inside], np.sqrt(density[inside, 0]), role))
    unit = f"{CHANNELS[channel].unit}/√Hz"
    title = Label(f"{channel_label(channel).text}, spectrum of the error")
    return Figure(
        f"spectrum-{channel}", title, "Frequency", "Hz", Label("error"), unit, tuple(traces), logarithmic=True
    )
