"""Identifications to be drawn: measured and fitted responses with their intervals, orders side by side."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from hil.analysis.frequency_response import FrequencyResponse, frf_from_csv
from hil.analysis.identification import Fit, fit_of
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.model import Model, load_model, parameter_unit
from hil.service.worker_pool.drawn_numbers import number, numbers

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_BAND_DRAWS = 100
_BAND_NAMES = ("fit_gain_lower_db", "fit_gain_upper_db", "fit_phase_lower_deg", "fit_phase_upper_deg")
_IN_95 = 1.959964  # standard deviations


def fitted(folder: str) -> dict[str, Any]:
    """Fields of `IdentificationData` from what `hil identify` wrote.

    Raises:
        BadInputError: a file is not there, or cannot be read.
    """
    place = Path(folder)
    summary = json.loads(read_text(place / "identification.json"))
    frf, model = frf_from_csv(place / "frf.csv"), load_model(place / "model.toml")
    fit = fit_of(model) if summary["verdict"] == "linear" else None
    band = None if fit is None else fit_band(fit, frf.frequency_hz)
    return {
        "verdict": summary["verdict"],
        "warnings": summary["warnings"],
        "resonance_hz": summary["resonance_hz"],
        "chain": summary["chain"],
        "frequency_hz": numbers(frf.frequency_hz),
        "outputs": [_output(frf, model, name, band) for name in frf.outputs],
        "parameters": _parameters(summary),
        "orders": [_order(place, frf, one) for one in summary["orders"]],
        "chains": [_chain(one) for one in summary["chains"]],
    }


def fit_band(fit: Fit, frequency_hz: Array) -> dict[str, ComplexArray]:
    """Responses drawn from a fit's covariance, by output: draws x frequencies, the fit itself first."""
    generator = np.random.default_rng(1)
    drawn = [fit.modes, *(fit.sample(generator) for _ in range(_BAND_DRAWS))]
    with np.errstate(all="ignore"):  # a pole that the data say nothing of has no bounds
        responses = np.array([one.response(frequency_hz) for one in drawn])
    return {name: responses[:, row] for row, name in enumerate(fit.outputs)}


def _band_fields(fit: ComplexArray, drawn: ComplexArray | None) -> dict[str, Any]:
    """95 % of the fit's own responses: 1.96 standard deviations of its draws, in dB and degrees."""
    if drawn is None:
        none = [None] * len(fit)
        return dict.fromkeys(_BAND_NAMES, none)
    with np.errstate(all="ignore"):
        ratio = drawn / fit
        decibel = _IN_95 * np.std(20 * np.log10(np.abs(ratio)), axis=0)
        degrees = _IN_95 * np.std(np.degrees(np.angle(ratio)), axis=0)
    gain, phase = 20 * np.log10(np.abs(fit)), np.degrees(np.unwrap(np.angle(fit)))
    edges = (gain - decibel, gain + decibel, phase - degrees, phase + degrees)
    return {name: numbers(edge) for name, edge in zip(_BAND_NAMES, edges, strict=True)}


def _output(
    frf: FrequencyResponse, model: Model, name: str, band: dict[str, ComplexArray] | None
) -> dict[str, Any]:
    if name not in model.transfer_functions:
        raise BadInputError(f"the model has no '{name}'", where="model.toml")
    measured, fit = frf.of(name), model.transfer_functions[name].response(frf.frequency_hz)
    return {
        "channel": name,
        "gain_db": numbers(20 * np.log10(np.abs(measured))),
        "phase_deg": numbers(np.degrees(np.unwrap(np.angle(measured)))),
        **_reach(measured, frf.deviation_of(name)),
        "coherence": numbers(frf.coherence[frf.outputs.index(name)]),
        "fit_gain_db": numbers(20 * np.log10(np.abs(fit))),
        "fit_phase_deg": numbers(np.degrees(np.unwrap(np.angle(fit)))),
        **_band_fields(fit, None if band is None else band[name]),
    }


def _order(place: Path, frf: FrequencyResponse, of: dict[str, Any]) -> dict[str, Any]:
    """Fields of `FittedOrder`; an identification of an earlier version has less of it."""
    responses, misfit = [], {}
    file = of.get("model") or ("model.toml" if of["chosen"] else "")
    if file and (place / file).is_file():
        functions = load_model(place / file).transfer_functions
        for name in frf.outputs:
            fit, measured = functions[name].response(frf.frequency_hz), frf.of(name)
            phase = np.degrees(np.unwrap(np.angle(fit)))
            gain = 20 * np.log10(np.abs(fit))
            responses.append({"channel": name, "gain_db": numbers(gain), "phase_deg": numbers(phase)})
            misfit[name] = _misfit(measured, fit)
    same = ("order", "integrator", "chosen", "held_out", "relative_excess", "dead_time_s")
    newer = ("dead_time_error_s", "chi_square", "bic")
    return {
        **{name: of[name] for name in same},
        **{name: number(of.get(name)) for name in newer},
        "parameters": of.get("parameters"),
        "resonances": [{key: number(one[key]) for key in one} for one in of.get("resonances", [])],
        "verdict": of.get("verdict", ""),
        "model": file,
        "misfit": misfit,
        "responses": responses,
    }


def _misfit(measured: ComplexArray, fit: ComplexArray) -> dict[str, float | None]:
    """Root mean square over frequency of gain in dB and of phase in degrees, noise included."""
    ratio = measured / fit
    gain_db, phase_deg = 20 * np.log10(np.abs(ratio)), np.degrees(np.angle(ratio))
    return {
        "gain_db": number(float(np.sqrt(np.mean(gain_db**2)))),
        "phase_deg": number(float(np.sqrt(np.mean(phase_deg**2)))),
    }


def _chain(of: dict[str, Any]) -> dict[str, Any]:
    """Fields of `FittedChain`."""
    errors = of["standard_errors"] or {}
    file = of.get("model") or ("physical.toml" if of["chosen"] else "")
    return {
        **{name: of[name] for name in ("kind", "chosen", "explains")},
        "model": file,
        "misfit": {
            name: {key: number(one[key]) for key in ("gain_db", "phase_deg")}
            for name, one in of["misfit"].items()
        },
        "parameters": [_parameter(name, value, errors.get(name)) for name, value in of["parameters"].items()],
    }


def _reach(measured: npt.NDArray[np.complex128], deviation: npt.NDArray[np.float64]) -> dict[str, Any]:
    """95 % intervals of gain and phase, of circular complex errors whose radial part has half their power
    (Pintelon and Schoukens, System Identification, 2nd ed., section 2.4)."""
    gain, phase = np.abs(measured), np.degrees(np.unwrap(np.angle(measured)))
    radial = _IN_95 * deviation / np.sqrt(2)
    sideways = np.degrees(np.arcsin(np.minimum(1.0, radial / gain)))
    lower = np.where(radial < gain, gain - radial, np.nan)
    return {
        "gain_lower_db": numbers(20 * np.log10(lower)),
        "gain_upper_db": numbers(20 * np.log10(gain + radial)),
        "phase_lower_deg": numbers(phase - sideways),
        "phase_upper_deg": numbers(phase + sideways),
    }


def _parameters(summary: dict[str, Any]) -> list[dict[str, Any]]:
    """Of the chain that was chosen; without one, the dead time alone is a physical number."""
    chosen = [one for one in summary["chains"] if one["chosen"]]
    if summary["chain"] is None or not chosen:
        dead = summary["dead_time_s"]
        return [_parameter("torque_delay", dead["value"], dead["standard_error"])]
    errors = {"torque_delay": summary["dead_time_s"]["standard_error"]} | (chosen[0]["standard_errors"] or {})
    return [_parameter(name, value, errors.get(name)) for name, value in chosen[0]["parameters"].items()]


def _parameter(name: str, value: float, error: float | None) -> dict[str, Any]:
    reach = None if error is None else _IN_95 * error
    return {
        "name": name,
        "unit": parameter_unit(name),
        "value": value,
        "lower": None if reach is None else value - reach,
        "upper": None if reach is None else value + reach,
    }
