"""The JSON schema of model files, for editors."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, SENSED, Effect
from hil.core.files.toml_file import FORMAT_SCHEMA
from hil.core.model import LOAD_INPUTS, MODEL_KINDS, WHEEL_RADII_M, parameter_names, parameter_unit

DRAFT = "https://json-schema.org/draft/2020-12/schema"
_NUMBER = {"type": "number"}


def model_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a model file.

    A model that `load_model` takes is valid; which effect goes with which kind, and that none stands twice,
    only `load_model` checks.
    """
    low, high = WHEEL_RADII_M
    return {
        "$schema": DRAFT,
        "title": "Model file",
        "type": "object",
        "properties": {
            "format": FORMAT_SCHEMA,
            "kind": {"enum": list(MODEL_KINDS), "description": "which equations"},
            "parameters": {"type": "object"},
            "tolerance": {"type": "object", "description": "how well parameters are known, relative"},
            "wheel_radius_m": {"type": "number", "minimum": low, "maximum": high},
            "load_input": {
                "enum": ["", *LOAD_INPUTS],
                "description": "recorded channel that brakes the wheels, or whose speed they have",
            },
            "effects": {"type": "array", "items": _effects()},
            "transfer_functions": _functions(),
            "meta": {"type": "object"},
        },
        "required": ["kind"],
        "additionalProperties": False,
        "allOf": [_of_kind(kind) for kind in MODEL_KINDS],
    }


def _of_kind(kind: str) -> dict[str, Any]:
    names = parameter_names(kind)
    parameters = {name: {**_NUMBER, "description": parameter_unit(name)} for name in names}
    own: dict[str, Any] = {
        "parameters": {
            "properties": parameters,
            "required": list(names),
            "additionalProperties": False,
        },
        "tolerance": {"properties": dict.fromkeys(names, _NUMBER), "additionalProperties": False},
    }
    needed = "transfer_functions" if kind == "transfer_function" else "parameters"
    if kind != "transfer_function":
        own["transfer_functions"] = False
    return {
        "if": {"properties": {"kind": {"const": kind}}, "required": ["kind"]},
        "then": {"properties": own, "required": [needed]},
    }


def _effects() -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {"id": {"enum": list(EFFECTS)}},
        "required": ["id"],
        "allOf": [_of_effect(effect) for effect in EFFECTS.values()],
    }


def _of_effect(effect: Effect) -> dict[str, Any]:
    texts = {name: _text(name) for name in effect.text_parameters}
    numbers = {
        p.name: {
            "type": "number",
            "minimum": p.lower,
            "maximum": p.upper,
            "description": f"{p.unit + ': ' if p.unit else ''}{p.meaning}",
        }
        for p in effect.parameters
    }
    needed = [*texts, *(p.name for p in effect.parameters if not p.optional)]
    return {
        "if": {"properties": {"id": {"const": effect.id}}},
        "then": {
            "description": effect.summary,
            "properties": {"id": {"const": effect.id}, **texts, **numbers},
            "required": needed,
            "additionalProperties": False,
        },
    }


def _text(name: str) -> dict[str, Any]:
    return {"enum": list(SENSED)} if name == "channel" else {"type": "string", "minLength": 1}


def _functions() -> dict[str, Any]:
    function = {
        "type": "object",
        "properties": {
            "numerator": _polynomial(),
            "denominator": _polynomial(),
            "delay": {"type": "number", "minimum": 0, "description": "s"},
        },
        "required": ["numerator", "denominator"],
        "additionalProperties": False,
    }
    return _table_of(OUTPUTS, function)


def _table_of(names: Iterable[str], entry: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": dict.fromkeys(names, entry),
        "minProperties": 1,
        "additionalProperties": False,
    }


def _polynomial() -> dict[str, Any]:
    return {
        "type": "array",
        "items": _NUMBER,
        "minItems": 1,
        "description": "descending powers of s, SI units",
    }
