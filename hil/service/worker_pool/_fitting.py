"""What an identification found, to be drawn: measured and fitted responses, parameters with intervals."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from hil.analysis.frequency_response import FrequencyResponse, frf_from_csv
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.model import Model, load_model, parameter_unit
from hil.service.worker_pool.drawn_numbers import numbers

_IN_95 = 1.959964  # standard deviations


def fitted(folder: str) -> dict[str, Any]:
    """Fields of `IdentificationData` from what `hil identify` wrote.

    Raises:
        BadInputError: a file is not there, or cannot be read.
    """
    place = Path(folder)
    summary = json.loads(read_text(place / "identification.json"))
    frf, model = frf_from_csv(place / "frf.csv"), load_model(place / "model.toml")
    return {
        "verdict": summary["verdict"],
        "warnings": summary["warnings"],
        "resonance_hz": summary["resonance_hz"],
        "chain": summary["chain"],
        "frequency_hz": numbers(frf.frequency_hz),
        "outputs": [_output(frf, model, name) for name in frf.outputs],
        "parameters": _parameters(summary),
    }


def _output(frf: FrequencyResponse, model: Model, name: str) -> dict[str, Any]:
    if name not in model.transfer_functions:
        raise BadInputError(f"the model has no '{name}'", where="model.toml")
    measured, fit = frf.of(name), model.transfer_functions[name].response(frf.frequency_hz)
    return {
        "channel": name,
        "gain_db": numbers(20 * np.log10(np.abs(measured))),
        "phase_deg": numbers(np.degrees(np.unwrap(np.angle(measured)))),
        "coherence": numbers(frf.coherence[frf.outputs.index(name)]),
        "fit_gain_db": numbers(20 * np.log10(np.abs(fit))),
        "fit_phase_deg": numbers(np.degrees(np.unwrap(np.angle(fit)))),
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
