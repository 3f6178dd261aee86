"""The JSON schema of bench files, for editors."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from hil.core.model.schema import DRAFT
from hil.engine.bench.bench_file import LOADED
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.device_kinds import DEFAULT_KINDS, KINDS


def bench_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a bench file, with the kinds of device of all installed packages.

    A bench that `load_bench` takes is valid; what one key says about another, and what stands in the files
    that are named, only `load_bench` checks.
    """
    definitions: dict[str, Any] = {}
    schema = _schema_of(BenchFile, definitions)
    for key in LOADED:
        schema["properties"].pop(key)
    kinds = {}
    for kind in KINDS.names():
        table = KINDS.find(kind)
        if table is not None:
            kinds[kind] = _schema_of(table, definitions)
    for key, default in DEFAULT_KINDS.items():
        schema["properties"][key] = _by_kind(kinds, default)
    schema["properties"]["devices"]["additionalProperties"] = _by_kind(kinds, "")
    definitions["Day"] = {"type": "string", "format": "date", "description": "last valid day, as 2027-06-30"}
    schema["properties"]["calibration"]["additionalProperties"] = {"$ref": "#/$defs/Day"}
    return {"$schema": DRAFT, **schema, "title": "Bench file", "$defs": definitions}


def _by_kind(kinds: dict[str, dict[str, Any]], default: str) -> dict[str, Any]:
    """A device's table: its `kind` says which keys it has; without one it is of the kind `default`."""
    variants = []
    for kind, schema in kinds.items():
        named = {"properties": {"kind": {"const": kind}}}
        required = [key for key in schema.get("required", []) if key != "kind"]
        variants.append(
            {
                "if": named if kind == default else {**named, "required": ["kind"]},
                "then": {
                    "properties": schema["properties"],
                    "required": required,
                    "additionalProperties": False,
                },
            }
        )
    names: dict[str, Any] = {"enum": list(kinds)}
    table: dict[str, Any] = {"type": "object", "properties": {"kind": names}, "allOf": variants}
    if default:
        names["default"] = default
    else:
        table["required"] = ["kind"]
    return table


def _schema_of(model: type[BaseModel], definitions: dict[str, Any]) -> dict[str, Any]:
    """A table's schema; tables within it move to `definitions`."""
    schema = model.model_json_schema()
    definitions |= schema.pop("$defs", {})
    return schema
