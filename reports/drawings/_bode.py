"""Measured and fitted frequency responses (Figs. 7-9) and their coherence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MultipleLocator

from hil.analysis.frequency_response import FrequencyResponse
from hil.core.channels import CHANNELS, INPUT
from reports.drawings import _canvas as style

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
_LOWEST = 1e-300
_DOTS: dict[str, Any] = {"color": style.SKY, "markersize": 4.5, "markeredgewidth": 0, "alpha": 0.75}


@dataclass(frozen=True)
class Curve:
    """A model's response (F complex values at `frequency_hz`) with its name in the legend."""

    name: str
    frequency_hz: Array
    response: ComplexArray


def bode(
    frf: FrequencyResponse, output: str, curves: tuple[Curve, ...], *, resonance_hz: float | None = None
) -> Figure:
    """Gain and phase of one output: measured points with a 95 % band, and curves.

    The phase is unwrapped along the first curve, so noise cannot make it jump.

    Args:
        frf: the measurement.
        output: which output.
        curves: at least one.
        resonance_hz: marked when given.
    """
    figure = style.new_figure(16, 12.5)
    gain, phase = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    frequency, response = frf.frequency_hz, frf.of(output)
    deviation = frf.deviation_of(output)
    size = np.maximum(np.abs(response), _LOWEST)
    style.mark_band(gain, resonance_hz)
    style.mark_band(phase, resonance_hz, named=False)
    # 1.73 σ holds 95 % of a complex normal error; the band is drawn as gain and phase.
    radius = np.clip(1.73 * deviation / size, 0, 0.95)
    gain.fill_between(
        frequency, _db(size * (1 - radius)), _db(size * (1 + radius)), color=style.SKY, alpha=0.4, linewidth=0
    )
    gain.plot(frequency, _db(size), "o", **_DOTS, label="measured, 95 % band")
    reference = _phase(curves[0].response)
    along = np.interp(np.log(frequency), np.log(curves[0].frequency_hz), reference)
    measured = along + np.degrees(np.angle(response * np.exp(-1j * np.radians(along))))
    turn = np.degrees(np.arcsin(radius))
    phase.fill_between(frequency, measured - turn, measured + turn, color=style.SKY, alpha=0.4, linewidth=0)
    phase.plot(frequency, measured, "o", **_DOTS)
    for curve, (colour, dash) in zip(
        curves, ((style.VERMILLION, "-"), (style.BLACK, "--"), (style.GREEN, ":")), strict=False
    ):
        gain.plot(
            curve.frequency_hz,
            _db(np.abs(curve.response)),
            dash,
            color=colour,
            linewidth=1.1,
            label=curve.name,
        )
        turned = _phase(curve.response)
        turned += 360 * np.round((reference[0] - turned[0]) / 360)
        phase.plot(curve.frequency_hz, turned, dash, color=colour, linewidth=1.1)
    channel, drive = CHANNELS[output], CHANNELS[INPUT]
    gain.set_title(
        f"{channel.meaning.split(',')[0].capitalize()} over motor torque, {_ratio(output)}", loc="left"
    )
    gain.set_ylabel(f"Gain in dB\n(1 {channel.unit} per {drive.unit})")
    phase.set_ylabel("Phase in degrees")
    phase.yaxis.set_major_locator(MultipleLocator(90))
    style.frequency_axis(gain, frequency[0], frequency[-1], label=False)
    style.frequency_axis(phase, frequency[0], frequency[-1])
    for axes in (gain, phase):
        style.style_axes(axes)
    style.legend(gain, loc="best")
    return figure


def coherence(frf: FrequencyResponse, *, least: float = 0.5, resonance_hz: float | None = None) -> Figure:
    """Coherence of every output, and the relative standard deviation below it."""
    figure = style.new_figure(16, 11)
    upper, lower = figure.subplots(2, 1, sharex=True)
    style.mark_band(upper, resonance_hz)
    style.mark_band(lower, resonance_hz, named=False)
    colours = (style.BLUE, style.VERMILLION, style.GREEN)
    for row, (name, colour) in enumerate(zip(frf.outputs, colours, strict=False)):
        upper.plot(frf.frequency_hz, frf.coherence[row], color=colour, linewidth=1.2, label=_ratio(name))
        relative = frf.standard_deviation[row] / np.maximum(np.abs(frf.response[row]), _LOWEST)
        lower.plot(frf.frequency_hz, 100 * relative, color=colour, linewidth=1.2)
    upper.axhline(least, color=style.GREY, linewidth=0.9, linestyle=":")
    upper.set_ylim(0, 1.03)
    upper.set_ylabel("Coherence")
    upper.set_title("Coherence and uncertainty", loc="left")
    lower.set_yscale("log")
    lower.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    lower.set_ylabel("Standard deviation in %")
    style.frequency_axis(upper, frf.frequency_hz[0], frf.frequency_hz[-1], label=False)
    style.frequency_axis(lower, frf.frequency_hz[0], frf.frequency_hz[-1])
    for axes in (upper, lower):
        style.style_axes(axes)
    style.legend(upper, loc="lower left", ncols=2)
    return figure


def _ratio(output: str) -> str:
    return f"{style.symbol(CHANNELS[output].symbol)} / {style.symbol(CHANNELS[INPUT].symbol)}"


def _db(size: Array) -> Array:
    return np.asarray(20 * np.log10(np.maximum(size, _LOWEST)))


def _phase(response: ComplexArray) -> Array:
    return np.asarray(np.degrees(np.unwrap(np.angle(response))))
