"""Model files (docs/reference/models.md): a plant's equations by kind, its parameters, its effects."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from hil.core.chain import WHEEL_RADIUS_M
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, finite_number, shown
from hil.core.errors import BadInputError
from hil.core.files import write_atomically
from hil.core.toml_file import load_toml

logger = logging.getLogger(__name__)

# name: (unit, may be zero)
_PARAMETER = {
    "motor_inertia": ("kg m2", False),
    "gear_ratio": ("motor speed / wheel speed", False),
    "shaft_stiffness": ("N m/rad", False),
    "shaft_damping": ("N m s/rad", True),
    "wheel_inertia": ("kg m2", False),
    "tyre_stiffness": ("N m/rad", False),
    "tyre_damping": ("N m s/rad", True),
    "vehicle_inertia": ("kg m2", False),
    "viscous_drag": ("N m s/rad", True),
    "torque_delay": ("s", True),
}
#: Kinds of model, and the parameters of each in file order.
MODEL_KINDS: dict[str, tuple[str, ...]] = {
    "rigid": ("motor_inertia", "gear_ratio", "vehicle_inertia", "viscous_drag", "torque_delay"),
    "two_inertia": (
        "motor_inertia",
        "gear_ratio",
        "shaft_stiffness",
        "shaft_damping",
        "vehicle_inertia",
        "torque_delay",
    ),
    "three_inertia": (
        "motor_inertia",
        "gear_ratio",
        "shaft_stiffness",
        "shaft_damping",
        "wheel_inertia",
        "tyre_stiffness",
        "tyre_damping",
        "vehicle_inertia",
        "torque_delay",
    ),
    "transfer_function": (),
}
_KEYS = (
    "kind",
    "parameters",
    "tolerance",
    "wheel_radius_m",
    "load_input",
    "effects",
    "transfer_functions",
    "meta",
)
#: Channels that may brake a model's wheels: positive against forward motion, left plus right.
LOAD_INPUTS = ("dyno_torque_ref_nm",)
_LARGEST_DELAY_S = 1.0
_LARGEST_TOLERANCE = 5.0  # relative: known to a factor of six
#: Smallest and largest radius of a wheel.
WHEEL_RADII_M = (0.01, 10.0)
_SIZES = (1e-12, 1e12)  # of a parameter in SI units: beyond, a unit is wrong and arithmetic overflows


@dataclass(frozen=True)
class TransferFunction:
    """numerator/denominator in descending powers of s, times exp(-delay_s·s)."""

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    delay_s: float = 0.0

    def response(self, frequency_hz: np.ndarray) -> np.ndarray:
        """Complex response at `frequency_hz` (any shape), dead time included."""
        s = 2j * np.pi * np.asarray(frequency_hz, dtype=float)
        ratio = np.polyval(self.numerator, s) / np.polyval(self.denominator, s)
        return np.asarray(ratio * np.exp(-self.delay_s * s))


@dataclass(frozen=True)
class EffectUse:
    """An effect of the registry with its values, as a model carries it."""

    id: str
    values: dict[str, float | str]


@dataclass(frozen=True)
class Model:
    """A plant model; the input is `motor_torque_ref_nm`, the outputs are `OUTPUTS`.

    `load_input` names a recorded channel whose torque brakes the wheels (the load where there is no wheel),
    beside what the model itself holds of the vehicle; '' for none.
    """

    kind: str
    parameters: dict[str, float] = field(default_factory=dict)
    effects: tuple[EffectUse, ...] = ()
    transfer_functions: dict[str, TransferFunction] = field(default_factory=dict)
    meta: dict[str, Any] = field(default_factory=dict)
    wheel_radius_m: float = WHEEL_RADIUS_M
    #: How well parameters are known, relative; those not named have the default of who asks.
    tolerance: dict[str, float] = field(default_factory=dict)
    load_input: str = ""

    def with_parameters(self, **changes: float) -> Model:
        """The same model with other parameter values."""
        parameters = self.parameters | changes
        return dataclasses.replace(self, parameters=parameters, meta=dict(self.meta))

    def with_effects(self, *effects: EffectUse) -> Model:
        """The same model with `effects` in place of its own."""
        return dataclasses.replace(
            self, parameters=dict(self.parameters), effects=effects, meta=dict(self.meta)
        )


def parameter_names(kind: str) -> tuple[str, ...]:
    """Names of the parameters that a model of `kind` has, in file order."""
    return MODEL_KINDS[kind]


def kind_of(kind: str, uses: Iterable[EffectUse]) -> str:
    """The kind that a model of `kind` is with effects added."""
    for use in uses:
        kind = EFFECTS[use.id].makes or kind
    return kind


def parameter_unit(name: str) -> str:
    """Unit of a model parameter, for people."""
    return _PARAMETER[name][0]


def load_model(path: Path) -> Model:
    """Read a model file.

    Raises:
        BadInputError: not readable, not TOML, or a key that is unknown, missing or not physical.
    """
    model = model_from_dict(load_toml(path), str(path))
    effects = ", ".join(use.id for use in model.effects) or "none"
    logger.debug("model %s: %s, effects: %s", path, model.kind, effects)
    return model


def model_from_dict(data: Mapping[str, Any], where: str) -> Model:
    """Check the contents of a model file; `where` names it in messages."""
    _no_others(data, _KEYS, "", where)
    kind = data.get("kind")
    if not isinstance(kind, str) or kind not in MODEL_KINDS:
        raise BadInputError(
            f"kind is {shown(kind)}", where=where, fix=f"kind is one of: {', '.join(MODEL_KINDS)}"
        )
    functions = _functions(data.get("transfer_functions"), kind, where)
    meta = data.get("meta", {})
    if not isinstance(meta, dict):
        raise BadInputError("[meta] is not a table", where=where)
    parameters = _parameters(data.get("parameters", {}), kind, where)
    effects = _effects(data.get("effects", []), kind, where)
    tolerance = _tolerance(data.get("tolerance", {}), kind, where)
    load = _load_input(data.get("load_input", ""), kind, where)
    return Model(kind, parameters, effects, functions, meta, _wheel_radius(data, where), tolerance, load)


def save_model(model: Model, path: Path) -> None:
    """Write a model file that `load_model` reads back to the same model."""
    write_atomically(path, model_to_toml(model))


def model_to_toml(model: Model) -> str:
    """The text of a model file."""
    data: dict[str, Any] = {"kind": model.kind}
    if model.wheel_radius_m != WHEEL_RADIUS_M:
        data["wheel_radius_m"] = model.wheel_radius_m
    if model.load_input:
        data["load_input"] = model.load_input
    if model.parameters:
        data["parameters"] = dict(model.parameters)
    if model.tolerance:
        data["tolerance"] = dict(model.tolerance)
    if model.transfer_functions:
        data["transfer_functions"] = {
            name: {"numerator": list(f.numerator), "denominator": list(f.denominator), "delay": f.delay_s}
            for name, f in model.transfer_functions.items()
        }
    if model.effects:
        data["effects"] = [{"id": use.id, **use.values} for use in model.effects]
    if model.meta:
        data["meta"] = model.meta
    return tomli_w.dumps(data)


def _no_others(table: Mapping[str, Any], known: tuple[str, ...], prefix: str, where: str) -> None:
    for key in table:
        if key not in known:
            raise BadInputError(
                f"unknown key '{prefix}{key}'", where=where, fix=f"known here: {', '.join(known) or 'none'}"
            )


def refuse_without_vehicle(model: Model, where: str, fix: str) -> None:
    """Refuse a model that takes its load from recordings where the vehicle is needed; `fix` is what to do.

    Raises:
        BadInputError: it has a `load_input`.
    """
    if model.load_input:
        raise BadInputError(
            f"the model takes {model.load_input} from recordings and does not hold the vehicle",
            where=where,
            fix=f"{fix} with a model of axle and vehicle, without load_input",
        )


def _load_input(value: Any, kind: str, where: str) -> str:
    if value == "":
        return ""
    if value not in LOAD_INPUTS:
        raise BadInputError(
            f"load_input is {shown(value)}", where=where, fix=f"known here: {', '.join(LOAD_INPUTS)}"
        )
    if kind == "transfer_function":
        raise BadInputError(
            "a 'transfer_function' model has no load_input: its functions are those of the motor torque",
            where=where,
            fix="give a rigid, two_inertia or three_inertia model",
        )
    return str(value)


def _wheel_radius(data: Mapping[str, Any], where: str) -> float:
    radius = _finite(data.get("wheel_radius_m", WHEEL_RADIUS_M), "wheel_radius_m", "m", where)
    if not WHEEL_RADII_M[0] <= radius <= WHEEL_RADII_M[1]:
        low, high = WHEEL_RADII_M
        raise BadInputError(
            f"wheel_radius_m = {radius:g} m", where=where, fix=f"give metres, from {low:g} to {high:g}"
        )
    return radius


def _parameters(table: Any, kind: str, where: str) -> dict[str, float]:
    if not isinstance(table, dict):
        raise BadInputError("[parameters] is not a table", where=where)
    names = MODEL_KINDS[kind]
    _no_others(table, names, "parameters.", where)
    checked = {}
    for name in names:
        if name not in table:
            raise BadInputError(f"parameters.{name} ({parameter_unit(name)}) is missing", where=where)
        checked[name] = _checked_parameter(name, table[name], f"parameters.{name}", where)
    return checked


def _tolerance(table: Any, kind: str, where: str) -> dict[str, float]:
    if not isinstance(table, dict):
        raise BadInputError("[tolerance] is not a table", where=where)
    _no_others(table, MODEL_KINDS[kind], "tolerance.", where)
    checked = {}
    for name, given in table.items():
        value = _finite(given, f"tolerance.{name}", "1 (0.05 for 5 %)", where)
        if not 0.0 < value <= _LARGEST_TOLERANCE:
            raise BadInputError(
                f"tolerance.{name} = {value:g}",
                where=where,
                fix=f"it is relative: 0.05 for 5 %, above 0 and at most {_LARGEST_TOLERANCE:g}",
            )
        checked[name] = value
    return checked


def _checked_parameter(name: str, given: Any, key: str, where: str) -> float:
    unit, may_be_zero = _PARAMETER[name]
    value = _finite(given, key, unit, where)
    if value < 0 or (value == 0 and not may_be_zero):
        raise BadInputError(
            f"{key} = {value:g} {unit}",
            where=where,
            fix="it must be positive" if not may_be_zero else "it must not be negative",
        )
    if name == "torque_delay" and value > _LARGEST_DELAY_S:
        raise BadInputError(f"{key} = {value:g} s", where=where, fix="is it in milliseconds? Give seconds")
    _sensible(value, key, unit, where)
    return value


def _sensible(value: float, key: str, unit: str, where: str) -> None:
    if value != 0 and not _SIZES[0] <= abs(value) <= _SIZES[1]:
        raise BadInputError(
            f"{key} = {value:g} {unit}",
            where=where,
            fix=f"it lies from {_SIZES[0]:g} to {_SIZES[1]:g}: is it in another unit?",
        )


def _finite(value: Any, key: str, unit: str, where: str) -> float:
    number = finite_number(value)
    if number is None:
        raise BadInputError(
            f"{key} is {shown(value)}, not a finite number",
            where=where,
            fix=f"give a plain number in {unit}",
        )
    return number


def _effects(entries: Any, kind: str, where: str) -> tuple[EffectUse, ...]:
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise BadInputError("effects must be written as [[effects]] tables", where=where)
    uses: list[EffectUse] = []
    for number, entry in enumerate(entries, 1):
        place = f"{where}: effects[{number}]"
        effect = EFFECTS.get(str(entry.get("id", "")))
        if effect is None:
            raise BadInputError(
                f"unknown effect id {shown(entry.get('id'))}", where=place, fix=f"known: {', '.join(EFFECTS)}"
            )
        if kind_of(kind, uses) not in effect.needs:
            raise BadInputError(
                f"'{effect.id}' cannot be added to a '{kind}' model",
                where=place,
                fix=f"it needs: {', '.join(effect.needs)}",
            )
        values = {key: value for key, value in entry.items() if key != "id"}
        use = EffectUse(effect.id, effect.check(values, place))
        if effect.id == "parameter_mismatch":
            _check_mismatch(use, kind, place)
        if any(_about(use) == _about(other) for other in uses):
            name = " of ".join(part for part in _about(use) if part)
            raise BadInputError(
                f"effect '{name}' stands twice", where=place, fix="merge the two [[effects]] tables"
            )
        uses.append(use)
    return tuple(uses)


def _about(use: EffectUse) -> tuple[str, str]:
    """Id, and the channel or parameter that the effect speaks of: each may stand once."""
    return use.id, str(use.values.get("channel", use.values.get("parameter", "")))


def _check_mismatch(use: EffectUse, kind: str, where: str) -> None:
    """A wrong value is one of a parameter that the model has, and must itself be possible."""
    name = str(use.values["parameter"])
    if name not in MODEL_KINDS[kind]:
        raise BadInputError(
            f"effect 'parameter_mismatch': a '{kind}' model has no parameter '{name}'",
            where=where,
            fix=f"it has: {', '.join(MODEL_KINDS[kind]) or 'none'}",
        )
    _checked_parameter(name, use.values["value"], f"effect 'parameter_mismatch': {name}", where)


def _functions(table: Any, kind: str, where: str) -> dict[str, TransferFunction]:
    if kind != "transfer_function":
        if table is not None:
            raise BadInputError(f"a '{kind}' model has no [transfer_functions]", where=where)
        return {}
    if not isinstance(table, dict) or not table:
        raise BadInputError(
            "[transfer_functions.motor_speed_rad_s] or another output is missing", where=where
        )
    _no_others(table, OUTPUTS, "transfer_functions.", where)
    return {name: _function(entry, f"transfer_functions.{name}", where) for name, entry in table.items()}


def _function(entry: Any, key: str, where: str) -> TransferFunction:
    if not isinstance(entry, dict):
        raise BadInputError(f"{key} is not a table", where=where)
    _no_others(entry, ("numerator", "denominator", "delay"), f"{key}.", where)
    polynomials = {}
    for part in ("numerator", "denominator"):
        values = entry.get(part)
        if not isinstance(values, list) or not values:
            raise BadInputError(f"{key}.{part} is missing: a list, descending powers of s", where=where)
        polynomials[part] = tuple(_finite(v, f"{key}.{part}", "SI units", where) for v in values)
    if polynomials["denominator"][0] == 0:
        raise BadInputError(f"{key}.denominator starts with 0", where=where)
    if len(polynomials["numerator"]) > len(polynomials["denominator"]):
        raise BadInputError(f"{key} is improper: its numerator has the higher order", where=where)
    delay = _finite(entry.get("delay", 0.0), f"{key}.delay", "s", where)
    if not 0 <= delay <= _LARGEST_DELAY_S:
        raise BadInputError(f"{key}.delay = {delay:g} s", where=where, fix="give seconds, from 0 to 1")
    return TransferFunction(polynomials["numerator"], polynomials["denominator"], delay)
