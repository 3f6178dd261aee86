"""What follows from a model, a controller or a bench file that somebody writes: read in another process."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hil.analysis.control_design import Margins, design_plant
from hil.analysis.tuning import SpeedLoops
from hil.core.channels import OUTPUTS, unit_of
from hil.core.controller import controller_from_toml
from hil.core.errors import BadInputError, HilError
from hil.core.errors.mistakes import Mistake, refuse
from hil.core.errors.wording import printable
from hil.core.files.toml_file import parse_toml
from hil.core.model import TransferFunction, load_model, model_from_dict
from hil.engine.bench.bench_file import bench_from_dict, shipped
from hil.engine.bench.named_files import named_files
from hil.engine.bench.ranges import limits_of_channels
from hil.plant import refuse_too_stiff
from hil.service.worker_pool.drawn_numbers import number

_DEVICE_FILES = (".dbc", ".eds", ".a2l")
_ON_THE_SERVICE = (
    "a bench on the service can only name the service's models and shipped device files, by name"
)


def file(kind: str, name: str, text: str, models: dict[str, str], model: str) -> dict[str, Any]:
    """Fields of `FileCheck` without its mistakes.

    Args:
        models: paths of the service's models by name.
        model: name of the one for a controller's margins; '' for none.

    Raises:
        BadInputError: all that is wrong with the file.
    """
    where, paths = f"{name}.toml", {key: Path(path) for key, path in models.items()}
    if kind == "model":
        return _of_model(text, where)
    if kind == "controller":
        return _of_controller(text, where, paths.get(model))
    return _of_bench(text, where, paths)


def _of_model(text: str, where: str) -> dict[str, Any]:
    model = model_from_dict(parse_toml(text, where), where, text)
    refuse_too_stiff(model)
    figures, notes = [_said("kind", model.kind)], [model.doubt] if model.doubt else []
    try:
        plant = design_plant(model)
        motor = plant.functions[OUTPUTS[0]]
        figures += [_figure("resonance", plant.resonance_hz, "Hz")]
        figures += [_figure("damping ratio of the resonance", _least_damping(motor.denominator), "1")]
        figures += _antiresonance(motor)
        figures += [_figure("dead time", 1e3 * plant.delay_s, "ms")]
        figures += [_figure("inertia seen by the motor", plant.inertia_kg_m2, "kg m²")]
        figures += [_figure("gear ratio", plant.gear_ratio, "1")]
        notes += plant.notes
    except HilError as error:
        notes.append(f"no controller can be designed for it: {error.what}")
    figures.append(_said("effects", ", ".join(use.id for use in model.effects) or "none"))
    return {"figures": figures, "notes": notes}


def _of_controller(text: str, where: str, path: Path | None) -> dict[str, Any]:
    controller = controller_from_toml(text, where)
    figures = [_said("stabilisation", controller.stabilization)]
    warnings = controller.meta.get("warnings")
    notes = [str(one) for one in warnings] if isinstance(warnings, list) else []
    if path is not None:
        try:
            found = SpeedLoops([load_model(path)], controller.sample_time_s).margins(controller, 0)
            figures += _of_margins(found)
        except HilError as error:
            notes.append(f"its loop cannot be computed on this model: {error.what}")
    return {"figures": figures, "notes": notes}


def _of_margins(found: Margins) -> list[dict[str, Any]]:
    return [
        _said("loop", "stable" if found.stable else "UNSTABLE"),
        _figure("gain margin", found.gain_margin_db, "dB"),
        _figure("phase margin", found.phase_margin_deg, "°"),
        _figure("delay margin", 1e3 * found.delay_margin_s, "ms"),
        _figure("largest sensitivity", found.sensitivity_peak, "1"),
        _figure("frequency of the largest sensitivity", found.sensitivity_peak_hz, "Hz"),
        _figure("largest sensitivity, 8 to 20 Hz", found.comfort_peak, "1"),
    ]


def _of_bench(text: str, where: str, models: Mapping[str, Path]) -> dict[str, Any]:
    data = parse_toml(text, where)
    _refuse_other_places(data, where, text)
    with tempfile.TemporaryDirectory() as folder:
        base = Path(folder)
        beside = [path for path in shipped("sim.toml").parent.iterdir() if path.suffix in _DEVICE_FILES]
        for path in beside:
            (base / path.name).symlink_to(path)
        for name, path in models.items():
            (base / f"{name}.toml").symlink_to(path.resolve())
        try:
            bench = bench_from_dict(data, text, base / where)
        except BadInputError as error:
            prefix = f"{base}/"
            what, place = error.what.replace(prefix, ""), error.where.replace(prefix, "")
            raise BadInputError(what, where=place, fix=error.fix) from None
        remarks = [text for table in bench.device_tables.values() for text in table.remarks()]
    figures = [_said("kind", "simulated" if bench.simulation is not None else "hardware")]
    figures += [_said("bus", f"{name}: {bus.interface} {bus.channel}") for name, bus in bench.buses.items()]
    figures += [_said("device", f"{name}: {table.kind}") for name, table in bench.device_tables.items()]
    limits = limits_of_channels(bench.limits)
    figures += [_figure(f"limit of {name}", value, unit_of(name)) for name, value in limits.items()]
    return {"figures": figures, "notes": remarks}


def _refuse_other_places(data: dict[str, Any], where: str, text: str) -> None:
    """Files elsewhere on the service's machine are not read for whoever names them.

    Raises:
        BadInputError: the bench file names one.
    """
    found = [
        Mistake(key, f"{key} = '{printable(value, 100)}' is not a name alone", _ON_THE_SERVICE)
        for key, value in named_files(data)
        if value != Path(value).name
    ]
    refuse(where, found, text)


def _antiresonance(motor: TransferFunction) -> list[dict[str, Any]]:
    zeros = _oscillating(motor.numerator)
    if not zeros.size:
        return []
    least = zeros[np.argmin(np.abs(zeros.real) / np.abs(zeros))]
    return [_figure("antiresonance of the motor speed", float(np.abs(least)) / (2 * np.pi), "Hz")]


def _least_damping(denominator: tuple[float, ...]) -> float:
    poles = _oscillating(denominator)
    return float(np.min(-poles.real / np.abs(poles))) if poles.size else np.nan


def _oscillating(polynomial: tuple[float, ...]) -> Any:
    roots = np.roots(polynomial)
    return roots[roots.imag > 1e-9 * np.max(np.abs(roots))] if roots.size else roots


def _figure(name: str, value: float, unit: str) -> dict[str, Any]:
    return {"name": name, "value": number(value), "unit": unit}


def _said(name: str, text: str) -> dict[str, Any]:
    return {"name": name, "value": None, "text": text}
