"""Figures of a diagnosis: measured and simulated before and after, over time and frequency, and gaps as bars.

Two bars a channel, in per cent of the signal: the model as it came, and the one given back. A line across
them says what noise alone makes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis import Curve, Diagnosis, Overlay
from hil.analysis.power_density import power_density
from hil.core.channels import CHANNELS, OUTPUTS
from hil.core.effects import EFFECTS
from reports import labels, style
from reports.figure import Figure, Trace
from reports.labels import Label, channel_label
from reports.svg_figure import svg_canvas

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = npt.NDArray[np.float64]

WINDOW_S = 1.5
_MEASURED = "Measured: the law with what the momentum does not account for, means of a fifth of a second."
_RECORDED = "Measured: torque of the shafts as recorded, over the twist of the model."


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


def curve_figures(found: Diagnosis) -> tuple[Figure, ...]:
    """The torques that are missing, as measured, each beside the law of its name."""
    return tuple(_curve_figure(number, curve) for number, curve in enumerate(found.curves, start=1))


def _curve_figure(number: int, curve: Curve) -> Figure:
    over, _, unit = curve.over.partition(" in ")
    named = curve.law_nm is not None
    title = EFFECTS[curve.effect.partition("(")[0]].title if named else "What stays without a name"
    measured = Trace(Label("measured"), curve.at, curve.torque_nm, "measured", points=True, width=2.0)
    law: tuple[Trace, ...] = ()
    if curve.law_nm is not None:
        law = (Trace(Label("its law"), curve.at, curve.law_nm, "gain", width=1.6),)
    return Figure(
        f"curve-{number}", Label(f"{title}: torque over {over}"), labels.capitalised(over), unit,
        Label("torque"), "N m", (*law, measured), caption=_MEASURED if over != "twist" else _RECORDED,
    )  # fmt: skip


def overlay_figure(overlay: Overlay) -> Figure:
    """Measured and simulated of the channel that the new model changes most, narrow."""
    column = int(np.argmax(_changes(overlay)))
    shown = _in_time(overlay, column, OUTPUTS[column])
    return replace(shown, id="before-and-after", wide=False, caption=f"Recording {overlay.name}.")


def _change(overlay: Overlay) -> float:
    """What the new model changes of the channel that it changes most."""
    return float(np.max(_changes(overlay), initial=0.0))


def _changes(overlay: Overlay) -> Array:
    """Mean square of what the new model changes of each channel, over its spread; 0 if not measured."""
    has = np.isfinite(overlay.measured[0])
    change = np.mean((overlay.after - overlay.before) ** 2, axis=0)
    return np.where(has, change / (np.var(overlay.measured, axis=0) + 1e-12), 0.0)


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


_LEFT_MM, _RIGHT_MM, _BOTTOM_MM, _TOP_MM = 30.0, 14.0, 8.5, 5.0
_ROW_MM, _BAR = 9.0, 0.36
_ROLES = {"before": "phase", "after": "gain"}


@dataclass(frozen=True)
class GapRow:
    """A channel: its name, and gaps and noise in per cent of the signal's rms."""

    name: str
    before: float
    after: float
    noise: float


@dataclass(frozen=True)
class GapBars:
    """Bars of all channels; `rows` from the top."""

    id: str
    title: Label
    rows: tuple[GapRow, ...]
    caption: str = ""
    wide: bool = True

    def alternative_text(self) -> str:
        """The picture in words."""
        lines = [
            f"{r.name}: before {_percent(r.before)}, after {_percent(r.after)}, noise {_percent(r.noise)}"
            for r in self.rows
        ]
        return f"{self.title.plain()}. " + "; ".join(lines) + "."

    def as_svg(self) -> bytes:
        """The picture in the house style for paper, a whole text line wide."""
        width, left = style.PAPER_WIDE_MM[0], _LEFT_MM
        height = _BOTTOM_MM + _TOP_MM + _ROW_MM * max(1, len(self.rows))
        with svg_canvas(width, height) as picture:
            canvas = picture.canvas
            box = (
                left / width,
                _BOTTOM_MM / height,
                1 - (left + _RIGHT_MM) / width,
                1 - (_BOTTOM_MM + _TOP_MM) / height,
            )
            axes = canvas.add_axes(box)
            self._draw(axes)
            canvas.legend(
                loc="upper left",
                bbox_to_anchor=(left / width, 1.0),
                ncols=3,
                borderaxespad=0.2,
                borderpad=0.1,
                handlelength=1.8,
            )
        return picture.svg

    def _draw(self, axes: Axes) -> None:
        for index, row in enumerate(self.rows):
            for turn, when in enumerate(("before", "after")):
                size, at = getattr(row, when), index + (turn - 0.5) * _BAR
                color = style.SERIES[_ROLES[when]].light
                axes.barh(at, size, _BAR, color=color, label=f"model {when}" if index == 0 else None)
                axes.annotate(
                    _percent(size), (size, at), (2, 0),
                    textcoords="offset points", va="center",
                )  # fmt: skip
            axes.plot(
                [row.noise, row.noise],
                [index - 1.25 * _BAR, index + 1.25 * _BAR],
                "--",
                color=style.SERIES["limit"].light,
                label="noise alone" if index == 0 else None,
            )
        axes.set_yticks(range(len(self.rows)), [row.name for row in self.rows])
        axes.set_ylim(len(self.rows) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        axes.set_xlim(0.0, max((max(r.before, r.after, r.noise) for r in self.rows), default=1.0) or 1.0)
        axes.set_xlabel("measured minus simulated, % of the signal (rms)", labelpad=2)


def _percent(value: float) -> str:
    """As the tables of a diagnosis have it."""
    return labels.share(value / 100.0, 2, digits=3)
