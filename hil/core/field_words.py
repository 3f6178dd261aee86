"""What pydantic finds wrong with a value, in the words of the bench's own messages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
_KINDS = {
    "float_type": "a number",
    "float_parsing": "a number, without quotes",
    "int_type": "a whole number",
    "int_parsing": "a whole number, without quotes",
    "int_from_float": "a whole number",
    "finite_number": "a finite number",
    "string_type": "a text in quotes",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
    "mapping_type": "a table",
    "list_type": "a list",
    "tuple_type": "a list",
}


def needed(mistake: Mapping[str, Any]) -> str:
    """What the value of one of pydantic's `errors()` should have been: 'must be at most 127'."""
    kind, context = str(mistake["type"]), mistake.get("ctx", {})
    if kind in _BOUNDS:
        key, words = _BOUNDS[kind]
        return f"must be {words} {_number(context[key])}"
    if kind in _KINDS:
        return f"must be {_KINDS[kind]}"
    if kind == "literal_error":
        return f"must be {context['expected']}"
    if kind == "string_too_short":
        least = context["min_length"]
        return "must not be empty" if least == 1 else f"must have at least {least} characters"
    if kind == "string_too_long":
        return f"must have at most {context['max_length']} characters"
    text = str(mistake["msg"]).removeprefix("Value error, ").removeprefix("Assertion failed, ")
    text = f"{text[:1].lower()}{text[1:]}"
    return text.replace("input should", "must", 1)


def _number(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
