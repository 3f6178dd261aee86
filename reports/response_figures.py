"""Frequency responses as interactive figures: measured points with their band, models, what models leave."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import FrequencyResponse
from hil.core.channels import CHANNELS, COMFORT_BAND_HZ, INPUT
from reports import labels
from reports.figure import Band, Figure, Trace
from reports.labels import Label, channel_label

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_LOWEST = 1e-300
_HALF_BAND = 1.73  # standard deviations that hold 95 % of a complex normal error
_WIDEST = 0.95  # of the response: a band wider than it has no lower edge in decibels
_ROLES = ("phase", "third", "fourth")
_OUTPUT_ROLES = ("gain", "phase", "third")


@dataclass(frozen=True)
class ModelResponse:
    """A model's name and its response: of each output F complex values at `frequency_hz`."""

    name: str
    frequency_hz: Array
    response: Mapping[str, ComplexArray]


def gain_figure(frf: FrequencyResponse, output: str, models: tuple[ModelResponse, ...]) -> Figure:
    """Gain of one output in dB: the models as lines, the measured points with a 95 % band above them."""
    size = np.maximum(np.abs(frf.of(output)), _LOWEST)
    radius = _radius(frf, output)
    spread = (_db(size * (1 - radius)), _db(size * (1 + radius)))
    measured = Trace(_MEASURED, frf.frequency_hz, _db(size), "gain", points=True, spread=spread)
    curves = [
        Trace(Label(m.name), m.frequency_hz, _db(np.abs(m.response[output])), role, dash)
        for m, role, dash in zip(models, _ROLES, ("solid", "dash", "dot"), strict=False)
    ]
    unit = f"dB re 1 {CHANNELS[output].unit} per {CHANNELS[INPUT].unit}"
    return _figure(frf, f"gain-{output}", _title(output, "gain"), "Gain", unit, (*curves, measured))


def phase_figure(frf: FrequencyResponse, output: str, models: tuple[ModelResponse, ...]) -> Figure:
    """Phase of one output in degrees, unwrapped along the first model, so that noise cannot make it jump."""
    reference = _phase(models[0].response[output])
    along = np.interp(np.log(frf.frequency_hz), np.log(models[0].frequency_hz), reference)
    turned = along + np.degrees(np.angle(frf.of(output) * np.exp(-1j * np.radians(along))))
    half = np.degrees(np.arcsin(_radius(frf, output)))
    spread = (turned - half, turned + half)
    measured = Trace(_MEASURED, frf.frequency_hz, turned, "gain", points=True, spread=spread)
    curves = []
    for m, role, dash in zip(models, _ROLES, ("solid", "dash", "dot"), strict=False):
        phase = _phase(m.response[output])
        phase += 360 * np.round((reference[0] - phase[0]) / 360)
        curves.append(Trace(Label(m.name), m.frequency_hz, phase, role, dash))
    return _figure(frf, f"phase-{output}", _title(output, "phase"), "Phase", "°", (*curves, measured))


def residual_figure(frf: FrequencyResponse, output: str, models: tuple[ModelResponse, ...]) -> Figure:
    """|measured - model| in percent of the model, beside the measurement's standard deviation."""
    frequency = frf.frequency_hz
    traces = []
    for m, role in zip(models, _ROLES, strict=False):
        at = _at(m, output, frequency)
        left = 100.0 * np.abs(frf.of(output) - at) / np.maximum(np.abs(at), _LOWEST)
        traces.append(Trace(Label(f"measured minus {m.name}"), frequency, left, role, points=True))
    size = np.maximum(np.abs(frf.of(output)), _LOWEST)
    noise = 100.0 * frf.deviation_of(output) / size
    traces.append(Trace(Label("standard deviation of the measurement"), frequency, noise, "reference"))
    figure = _figure(frf, f"residual-{output}", _title(output, "residual"), "Residual", "%", tuple(traces))
    values = np.concatenate([trace.y for trace in traces])
    low = max(float(np.min(values[values > 0], initial=1.0)), 1e-4)
    high = max(float(np.max(values[np.isfinite(values)], initial=0.0)), 10 * low)
    return replace(figure, logarithmic=True, y_range=(low, 2 * high))


def coherence_figure(frf: FrequencyResponse, least: float) -> Figure:
    """Coherence of every output over frequency."""
    traces = tuple(
        Trace(channel_label(name), frf.frequency_hz, frf.coherence[row], role)
        for row, (name, role) in enumerate(zip(frf.outputs, _OUTPUT_ROLES, strict=False))
    )
    caption = f"Median required for chirps and steps: {labels.nominal(least)}."
    figure = _figure(frf, "coherence", Label("Coherence"), "Coherence", "", traces)
    return replace(figure, y_range=(0.0, 1.05), caption=caption)


_MEASURED = Label("measured, 95 % band")


def _figure(
    frf: FrequencyResponse, id_: str, title: Label, text: str, unit: str, traces: tuple[Trace, ...]
) -> Figure:
    first, last = float(frf.frequency_hz[0]), float(frf.frequency_hz[-1])
    low, high = max(COMFORT_BAND_HZ[0], first), min(COMFORT_BAND_HZ[1], last)
    name = f"{COMFORT_BAND_HZ[0]:g}{labels.DASH}{COMFORT_BAND_HZ[1]:g}{labels.THIN}Hz"
    return Figure(
        id=id_,
        title=title,
        x_text="Frequency",
        x_unit="Hz",
        y_label=Label(text),
        y_unit=unit,
        traces=traces,
        bands=(Band(low, high, name),) if high > low else (),
        x_range=(first, last),
        logarithmic_x=True,
    )


def _title(output: str, what: str) -> Label:
    label = channel_label(output)
    return Label(label.text, label.symbol, f" over motor torque, {what}")


def _radius(frf: FrequencyResponse, output: str) -> Array:
    size = np.maximum(np.abs(frf.of(output)), _LOWEST)
    return np.asarray(np.clip(_HALF_BAND * frf.deviation_of(output) / size, 0.0, _WIDEST))


def _at(model: ModelResponse, output: str, frequency_hz: Array) -> ComplexArray:
    """The model at other frequencies, its gain and phase interpolated over the logarithm of frequency."""
    response, over = model.response[output], np.log(model.frequency_hz)
    gain = np.interp(np.log(frequency_hz), over, np.log(np.maximum(np.abs(response), _LOWEST)))
    phase = np.interp(np.log(frequency_hz), over, np.unwrap(np.angle(response)))
    return np.asarray(np.exp(gain + 1j * phase))


def _db(size: Array) -> Array:
    return np.asarray(20.0 * np.log10(np.maximum(size, _LOWEST)))


def _phase(response: ComplexArray) -> Array:
    return np.asarray(np.degrees(np.unwrap(np.angle(response))))
