"""Open loops as the paper shows them: Nyquist (Fig. 11), sensitivity (Fig. 12), trade-off (Fig. 10)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from hil.analysis.control_design import TradeOff
from reports.drawings import _canvas as style

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Loops = Mapping[str, ComplexArray]

_LOOKS = {
    "plant": ("plant alone", style.BLUE),
    "pi": ("PI", style.VERMILLION),
    "phase": ("PI and lead", style.BLACK),
    "gain": ("PI and notch", style.GREEN),
}


def nyquist(
    frequency_hz: Array,
    loops: Loops,
    resonance_hz: float,
    *,
    measured_hz: Array | None = None,
    measured: Loops | None = None,
) -> Figure:
    """Open loops in the complex plane: the model, and beside it the measured points where there are any.

    Rings mark the resonance, the dotted circle is gain one, the solid one |S| = 1: inside it
    disturbances grow.

    Args:
        frequency_hz: F frequencies of the loops.
        loops: by name ('plant', 'pi', 'phase', 'gain'), F values each.
        resonance_hz: where the rings are.
        measured_hz: M frequencies of the measurement.
        measured: like `loops`, M values each.
    """
    both = measured is not None and measured_hz is not None
    figure = style.new_figure(22 if both else 13, 12.5)
    panels = figure.subplots(1, 2 if both else 1, squeeze=False)[0]
    reach = _reach(frequency_hz, loops)
    _nyquist_panel(panels[0], frequency_hz, loops, resonance_hz, reach, "-")
    panels[0].set_title("Open loop, fitted model", loc="left")
    if measured is not None and measured_hz is not None:
        _nyquist_panel(panels[1], measured_hz, measured, resonance_hz, reach, ".")
        panels[1].set_title("Open loop, measured plant", loc="left")
    for axes in panels:
        style.style_axes(axes)
    handles, labels = panels[0].get_legend_handles_labels()
    columns = 5 if both else 3
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False, fontsize=8.5)
    return figure


def sensitivity(
    frequency_hz: Array,
    loops: Loops,
    resonance_hz: float,
    *,
    measured_hz: Array | None = None,
    measured: Loops | None = None,
) -> Figure:
    """|S| = 1/|1 + L| in dB for the controlled loops; arguments as for `nyquist`."""
    figure = style.new_figure(16, 10)
    axes = figure.subplots()
    style.mark_band(axes, resonance_hz)
    axes.axhline(0, color=style.GREY, linewidth=0.9)
    low, high = 0.1, min(100.0, float(frequency_hz[-1]))
    top, bottom = 6.0, -20.0
    for name, loop in loops.items():
        if name == "plant":
            continue
        label, colour = _LOOKS[name]
        values = -20 * np.log10(np.maximum(np.abs(1 + loop), 1e-300))
        axes.plot(frequency_hz, values, color=colour, linewidth=1.4, label=label)
        shown = values[(frequency_hz > low) & (frequency_hz < high)]
        top, bottom = max(top, float(np.max(shown))), min(bottom, float(np.min(shown)))
        if measured is not None and measured_hz is not None and name in measured:
            points = -20 * np.log10(np.maximum(np.abs(1 + measured[name]), 1e-300))
            axes.plot(measured_hz, points, ".", color=colour, markersize=3, alpha=0.6)
    axes.set_ylim(max(bottom - 3, -60), min(top + 3, 30))
    axes.set_ylabel("Sensitivity |S| in dB")
    title = "Sensitivity of the wheel speed control"
    axes.set_title(title + (", dots: measured plant" if measured is not None else ""), loc="left")
    style.frequency_axis(axes, low, high)
    style.style_axes(axes)
    style.legend(axes, loc="lower right")
    return figure


def trade_off_chart(
    chart: TradeOff, *, chosen: tuple[float, float] | None = None, chosen_name: str = "chosen"
) -> Figure:
    """Phase at the resonance against the sensitivity peak, a line for each lead frequency.

    Points are lead angles; every second one is labelled. `chosen` is (phase in degrees, peak).
    """
    figure = style.new_figure(16, 11)
    axes = figure.subplots()
    colours = (style.BLUE, style.SKY, style.GREEN, style.VERMILLION, style.ORANGE, style.PURPLE)
    marks = ("o", "s", "^", "D", "v", "P")
    for b, (frequency, colour, mark) in enumerate(zip(chart.frequencies_hz, colours, marks, strict=False)):
        axes.plot(
            chart.phase_deg[:, b],
            chart.sensitivity_peak[:, b],
            marker=mark,
            markersize=4,
            color=colour,
            linewidth=1.1,
            label=f"lead at {frequency:g} Hz",
        )
    widest = int(np.nanargmax(np.ptp(np.nan_to_num(chart.phase_deg), axis=0)))
    for a in range(1, len(chart.angles_deg), 2):
        if np.isfinite(chart.sensitivity_peak[a, widest]):
            axes.annotate(
                f"{chart.angles_deg[a]:g}°",
                (chart.phase_deg[a, widest], chart.sensitivity_peak[a, widest]),
                textcoords="offset points",
                xytext=(5, 5),
                fontsize=7,
                color=colours[widest],
            )
    if chosen is not None:
        axes.plot(
            *chosen,
            marker="*",
            markersize=13,
            color=style.BLACK,
            linestyle="none",
            label=chosen_name,
            zorder=5,
        )
    axes.axvline(0, color=style.GREY, linewidth=0.9, linestyle=(0, (4, 2)))
    axes.set_yscale("log")
    finite = chart.sensitivity_peak[np.isfinite(chart.sensitivity_peak)]
    if finite.size:
        axes.set_ylim(max(1.0, 0.93 * float(np.min(finite))), min(12.0, 1.1 * float(np.max(finite))))
    axes.yaxis.set_major_locator(FixedLocator([1, 1.2, 1.5, 2, 3, 4, 5, 7, 10]))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("Phase of the open loop at the resonance in degrees")
    axes.set_ylabel("Sensitivity peak |S|max")
    axes.set_title("Trade-off of the phase lead (points: lead angle)", loc="left")
    style.style_axes(axes)
    style.legend(axes, loc="best")
    return figure


def _nyquist_panel(
    axes: Axes, frequency_hz: Array, loops: Loops, resonance_hz: float, reach: float, line: str
) -> None:
    axes.add_patch(Circle((0, 0), 1, fill=False, color=style.PURPLE, linestyle=":", linewidth=1.2))
    axes.add_patch(Circle((-1, 0), 1, fill=False, color=style.PURPLE, linewidth=1.2))
    axes.plot([-1], [0], "+", color=style.PURPLE, markersize=8)
    for name, loop in loops.items():
        label, colour = _LOOKS[name]
        axes.plot(loop.real, loop.imag, line, color=colour, linewidth=1.3, markersize=2.5, label=label)
        if frequency_hz[0] <= resonance_hz <= frequency_hz[-1]:
            here = np.interp(resonance_hz, frequency_hz, loop)
            axes.plot(
                here.real, here.imag, "o", color=colour, markerfacecolor="white", markersize=6, zorder=4
            )
    axes.plot([], [], "o", color=style.GREY, markerfacecolor="white", label=f"{resonance_hz:.1f} Hz")
    axes.set_aspect("equal")
    axes.set_xlim(-0.62 * reach, reach)
    axes.set_ylim(-reach, 0.62 * reach)
    axes.set_xlabel("Real part")
    axes.set_ylabel("Imaginary part")


def _reach(frequency_hz: Array, loops: Loops) -> float:
    above = frequency_hz > 4.0
    largest = max(float(np.max(np.abs(loop[above]), initial=0.0)) for loop in loops.values())
    return float(np.clip(1.2 * largest, 2.5, 8.0))
