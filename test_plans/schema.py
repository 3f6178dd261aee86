"""The JSON schema of plans, for editors."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from hil.core.model.schema import DRAFT
from test_plans.criteria import CriterionKeys
from test_plans.metrics import METRICS
from test_plans.plan import PlanKeys
from test_plans.steps import STEPS
from test_plans.variables import NAME


def plan_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a plan's YAML, with the steps and metrics of all installed packages.

    A plan that `load_plan` takes is valid; what one key says about another (from below to, unknown
    segments) only `load_plan` checks.
    """
    definitions: dict[str, Any] = {}
    steps = {"type": "array", "items": {"$ref": "#/$defs/step"}}
    keys = _schema_of(PlanKeys, definitions)
    definitions["step"] = _step_schema(definitions)
    definitions["criterion"] = _criterion_schema(definitions)
    return {
        "$schema": DRAFT,
        "title": "Test plan",
        "type": "object",
        "properties": {
            **keys["properties"],
            "steps": {**steps, "minItems": 1, "description": "steps, in order"},
            "finally": {
                **steps,
                "type": ["array", "null"],
                "description": "steps at the end, run in any case",
            },
            "criteria": {"type": ["array", "null"], "items": {"$ref": "#/$defs/criterion"}},
        },
        "required": ["name", "steps"],
        "additionalProperties": False,
        "$defs": definitions,
    }


def _step_schema(definitions: dict[str, Any]) -> dict[str, Any]:
    kinds: dict[str, Any] = {}
    for kind in STEPS.names():
        step = STEPS.find(kind)
        if step is None:
            continue
        kinds[kind] = _schema_of(step, definitions)
        kinds[kind]["properties"] = {
            key: _or_variable(value) for key, value in kinds[kind]["properties"].items()
        }
        for key in step.nested:
            kinds[kind]["properties"][key]["items"] = {"$ref": "#/$defs/step"}
    return {
        "type": "object",
        "properties": kinds,
        "minProperties": 1,
        "maxProperties": 1,
        "additionalProperties": False,
    }


def _criterion_schema(definitions: dict[str, Any]) -> dict[str, Any]:
    keys = _schema_of(CriterionKeys, definitions)
    names = METRICS.names()
    variants = []
    for name in names:
        metric = METRICS.find(name)
        if metric is None:
            continue
        own = _schema_of(metric, definitions)
        variants.append(
            {
                "if": {"properties": {"metric": {"const": name}}, "required": ["metric"]},
                "then": {
                    "properties": {
                        key: _or_variable(value)
                        for key, value in (keys["properties"] | own.get("properties", {})).items()
                    },
                    "required": own.get("required", []),
                    "additionalProperties": False,
                },
            }
        )
    return {
        "type": "object",
        "properties": {"metric": {"enum": list(names)}},
        "required": keys["required"],
        "allOf": variants,
    }


def _or_variable(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema of a key, which takes a variable where it takes a number."""
    variable = {"type": "string", "pattern": f"^\\$({NAME}|\\{{{NAME}\\}})$"}
    if schema.get("type") in ("number", "integer"):
        meaning: dict[str, Any] = {
            key: schema[key] for key in ("description", "default", "title") if key in schema
        }
        return {**meaning, "anyOf": [schema, variable]}
    if any(one.get("type") in ("number", "integer") for one in schema.get("anyOf", ())):
        return {**schema, "anyOf": [*schema["anyOf"], variable]}
    if "items" in schema and isinstance(schema["items"], dict):
        return {**schema, "items": _or_variable(schema["items"])}
    return schema


def _schema_of(model: type[BaseModel], definitions: dict[str, Any]) -> dict[str, Any]:
    """A model's schema; models within it move to `definitions` under the outer one's name."""
    prefix = model.__name__
    schema = model.model_json_schema(ref_template=f"#/$defs/{prefix}.{{model}}")
    for name, inner in schema.pop("$defs", {}).items():
        definitions[f"{prefix}.{name}"] = inner
    return schema
