"""Checks the contents of a model file; every mistake is reported, each with its line and its key."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hil.core.chain import WHEEL_RADIUS_M
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, finite_number, shown
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import Mistakes
from hil.core.errors.wording import closest, did_you_mean
from hil.core.files.toml_file import FORMAT, readable_format, refuse_other_kind
from hil.core.model._types import (
    LOAD_INPUTS,
    MODEL_KINDS,
    PARAMETERS,
    WHEEL_RADII_M,
    EffectUse,
    Model,
    TransferFunction,
    kind_of,
    parameter_unit,
)

_KEYS = (
    "format",
    "kind",
    "parameters",
    "tolerance",
    "wheel_radius_m",
    "load_input",
    "effects",
    "transfer_functions",
    "meta",
)
_FUNCTION_KEYS = ("numerator", "denominator", "delay")
_LARGEST_DELAY_S = 1.0
_LARGEST_TOLERANCE = 5.0  # relative: known to a factor of six
_SIZES = (1e-12, 1e12)  # of a parameter in SI units: beyond, a unit is wrong and arithmetic overflows


def model_from_dict(data: Mapping[str, Any], where: str, text: str = "") -> Model:
    """Check the contents of a model file.

    Args:
        where: names the file in messages.
        text: its text, for the lines of mistakes.

    Raises:
        BadInputError: every key that is unknown, missing or not physical.
    """
    refuse_other_kind(data, "model", where)
    mistakes = Mistakes()
    _no_others(data, _KEYS, "", mistakes)
    with mistakes.of("format"):
        _readable(data.get("format", FORMAT))
    kind = ""
    with mistakes.of("kind"):
        kind = _kind(data.get("kind"))
    if not kind:
        mistakes.refuse(where, text)
    model = Model(
        kind,
        _parameters(data.get("parameters", {}), kind, mistakes),
        _effects(data.get("effects", []), kind, mistakes),
        _functions(data.get("transfer_functions"), kind, mistakes),
        _table(data.get("meta", {}), "meta", mistakes),
        _wheel_radius(data, mistakes),
        _tolerance(data.get("tolerance", {}), kind, mistakes),
        _load_input(data.get("load_input", ""), kind, mistakes),
        where,
    )
    mistakes.refuse(where, text)
    return model


def _readable(number: Any) -> None:
    try:
        readable_format(number)
    except ValueError as error:
        raise BadInputError(f"format = {shown(number)}: {error}") from None


def _kind(kind: Any) -> str:
    if isinstance(kind, str) and kind in MODEL_KINDS:
        return kind
    what = "kind is missing" if kind is None else f"kind is {shown(kind)}"
    known = f"kind is one of {', '.join(MODEL_KINDS)}"
    raise BadInputError(what, fix=did_you_mean(kind, MODEL_KINDS) if isinstance(kind, str) else known)


def _table(value: Any, name: str, mistakes: Mistakes) -> dict[str, Any]:
    if isinstance(value, dict):
        return value
    with mistakes.of(name):
        raise BadInputError(f"[{name}] is not a table")
    return {}


def _no_others(table: Mapping[str, Any], known: tuple[str, ...], prefix: str, mistakes: Mistakes) -> None:
    for key in table:
        if key not in known:
            with mistakes.of(f"{prefix}{key}"):
                raise BadInputError(f"unknown key '{prefix}{key}'", fix=did_you_mean(key, known))


def _load_input(value: Any, kind: str, mistakes: Mistakes) -> str:
    with mistakes.of("load_input"):
        if value and value not in LOAD_INPUTS:
            raise BadInputError(f"load_input is {shown(value)}", fix=f"known here: {', '.join(LOAD_INPUTS)}")
        if value and kind == "transfer_function":
            raise BadInputError(
                "a 'transfer_function' model has no load_input: its functions are those of the motor torque",
                fix="give a rigid, two_inertia or three_inertia model",
            )
        if not isinstance(value, str):
            raise BadInputError(f"load_input is {shown(value)}", fix=f"known here: {', '.join(LOAD_INPUTS)}")
        return value
    return ""


def _wheel_radius(data: Mapping[str, Any], mistakes: Mistakes) -> float:
    with mistakes.of("wheel_radius_m"):
        radius = _finite(data.get("wheel_radius_m", WHEEL_RADIUS_M), "wheel_radius_m", "m")
        low, high = WHEEL_RADII_M
        if not low <= radius <= high:
            raise BadInputError(
                f"wheel_radius_m = {radius:g} m", fix=f"give metres, from {low:g} to {high:g}"
            )
        return radius
    return WHEEL_RADIUS_M


def _parameters(given: Any, kind: str, mistakes: Mistakes) -> dict[str, float]:
    table, names = _table(given, "parameters", mistakes), MODEL_KINDS[kind]
    _no_others(table, names, "parameters.", mistakes)
    meant = {closest(key, names) for key in table if key not in names}
    checked = {}
    for name in names:
        if name not in table and name in meant:  # its misspelling has been reported
            continue
        key = f"parameters.{name}"
        with mistakes.of(key):
            if name not in table:
                raise BadInputError(f"{key} ({parameter_unit(name)}) is missing")
            checked[name] = _checked_parameter(name, table[name], key)
    return checked


def _tolerance(given: Any, kind: str, mistakes: Mistakes) -> dict[str, float]:
    table = _table(given, "tolerance", mistakes)
    _no_others(table, MODEL_KINDS[kind], "tolerance.", mistakes)
    checked = {}
    for name in table.keys() & MODEL_KINDS[kind]:
        with mistakes.of(f"tolerance.{name}"):
            value = _finite(table[name], f"tolerance.{name}", "1 (0.05 for 5 %)")
            if not 0.0 < value <= _LARGEST_TOLERANCE:
                raise BadInputError(
                    f"tolerance.{name} = {value:g}",
                    fix=f"it is relative: 0.05 for 5 %, above 0 and at most {_LARGEST_TOLERANCE:g}",
                )
            checked[name] = value
    return {name: checked[name] for name in table if name in checked}


def _checked_parameter(name: str, given: Any, key: str) -> float:
    unit, may_be_zero = PARAMETERS[name]
    value = _finite(given, key, unit)
    if value < 0 or (value == 0 and not may_be_zero):
        raise BadInputError(
            f"{key} = {value:g} {unit}",
            fix="it must be positive" if not may_be_zero else "it must not be negative",
        )
    if name == "torque_delay" and value > _LARGEST_DELAY_S:
        raise BadInputError(f"{key} = {value:g} s", fix="is it in milliseconds? Give seconds")
    if value != 0 and not _SIZES[0] <= abs(value) <= _SIZES[1]:
        raise BadInputError(
            f"{key} = {value:g} {unit}",
            fix=f"it lies from {_SIZES[0]:g} to {_SIZES[1]:g}: is it in another unit?",
        )
    return value


def _finite(value: Any, key: str, unit: str) -> float:
    number = finite_number(value)
    if number is None:
        raise BadInputError(
            f"{key} is {shown(value)}, not a finite number", fix=f"give a plain number in {unit}"
        )
    return number


def _effects(entries: Any, kind: str, mistakes: Mistakes) -> tuple[EffectUse, ...]:
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        with mistakes.of("effects"):
            raise BadInputError("effects must be written as [[effects]] tables")
        return ()
    uses: list[EffectUse] = []
    for number, entry in enumerate(entries, 1):
        with mistakes.of(f"effects[{number}]"):
            uses.append(_effect(entry, kind, uses))
    _check_together(uses, mistakes)
    return tuple(uses)


def _check_together(uses: list[EffectUse], mistakes: Mistakes) -> None:
    """Values that make no sense beside the other effects."""
    others = {use.id: use.values for use in uses}
    for number, use in enumerate(uses, 1):
        together = EFFECTS[use.id].together
        senseless = together(use.values, others) if together is not None else None
        if senseless is not None:
            with mistakes.of(f"effects[{number}]"):
                raise BadInputError(f"'{use.id}': {senseless[0]}", fix=senseless[1])


def _effect(entry: Mapping[str, Any], kind: str, others: list[EffectUse]) -> EffectUse:
    id_ = entry.get("id")
    effect = EFFECTS.get(str(id_))
    if effect is None:
        fix = did_you_mean(id_, EFFECTS) if isinstance(id_, str) else f"known: {', '.join(EFFECTS)}"
        raise BadInputError(f"unknown effect id {shown(id_)}", fix=fix)
    if kind_of(kind, others) not in effect.needs:
        raise BadInputError(
            f"'{effect.id}' cannot be added to a '{kind}' model", fix=f"it needs: {', '.join(effect.needs)}"
        )
    values = {key: value for key, value in entry.items() if key != "id"}
    use = EffectUse(effect.id, effect.check(values, ""))
    if effect.id == "parameter_mismatch":
        _check_mismatch(use, kind)
    if any(_about(use) == _about(other) for other in others):
        name = " of ".join(part for part in _about(use) if part)
        raise BadInputError(f"effect '{name}' stands twice", fix="merge the two [[effects]] tables")
    return use


def _about(use: EffectUse) -> tuple[str, str]:
    """Id, and the channel or parameter that the effect speaks of: each may stand once."""
    return use.id, str(use.values.get("channel", use.values.get("parameter", "")))


def _check_mismatch(use: EffectUse, kind: str) -> None:
    """A wrong value is one of a parameter that the model has, and must itself be possible."""
    name = str(use.values["parameter"])
    if name not in MODEL_KINDS[kind]:
        raise BadInputError(
            f"effect 'parameter_mismatch': a '{kind}' model has no parameter '{name}'",
            fix=f"it has: {', '.join(MODEL_KINDS[kind]) or 'none'}",
        )
    _checked_parameter(name, use.values["value"], f"effect 'parameter_mismatch': {name}")


def _functions(table: Any, kind: str, mistakes: Mistakes) -> dict[str, TransferFunction]:
    found = {}
    with mistakes.of("transfer_functions"):
        if kind != "transfer_function" and table is not None:
            raise BadInputError(f"a '{kind}' model has no [transfer_functions]")
        if kind == "transfer_function" and (not isinstance(table, dict) or not table):
            raise BadInputError("[transfer_functions.motor_speed_rad_s] or another output is missing")
    if kind != "transfer_function" or not isinstance(table, dict):
        return {}
    _no_others(table, OUTPUTS, "transfer_functions.", mistakes)
    for name in [name for name in table if name in OUTPUTS]:
        key = f"transfer_functions.{name}"
        if isinstance(table[name], dict):
            _no_others(table[name], _FUNCTION_KEYS, f"{key}.", mistakes)
        with mistakes.of(key):
            found[name] = _function(table[name], key)
    return found


def _function(entry: Any, key: str) -> TransferFunction:
    if not isinstance(entry, dict):
        raise BadInputError(f"{key} is not a table")
    polynomials = {}
    for part in ("numerator", "denominator"):
        values = entry.get(part)
        if not isinstance(values, list) or not values:
            raise BadInputError(f"{key}.{part} is missing: a list, descending powers of s")
        polynomials[part] = tuple(_finite(v, f"{key}.{part}", "SI units") for v in values)
    if polynomials["denominator"][0] == 0:
        raise BadInputError(f"{key}.denominator starts with 0")
    if len(polynomials["numerator"]) > len(polynomials["denominator"]):
        raise BadInputError(f"{key} is improper: its numerator has the higher order")
    delay = _finite(entry.get("delay", 0.0), f"{key}.delay", "s")
    if not 0 <= delay <= _LARGEST_DELAY_S:
        raise BadInputError(f"{key}.delay = {delay:g} s", fix="give seconds, from 0 to 1")
    return TransferFunction(polynomials["numerator"], polynomials["denominator"], delay)
