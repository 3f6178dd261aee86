"""What is wrong with a table of a TOML file: pydantic's errors by key, value and what would be right."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from hil.core.errors.mistakes import keyed
from hil.core.errors.wording import closest, printable


def mistakes_of(
    error: ValidationError, model: type[BaseModel], key: str = "", known: list[str] | None = None
) -> list[str]:
    """Each of pydantic's errors: key, value, and what would be right.

    Args:
        model: what the table should be.
        key: of the table that was checked.
        known: mistakes that were reported; what concerns the same table again is left out.
    """
    tables = {keyed(mistake).key for mistake in known or ()}
    found, meant = [], _meant(error, model)
    for mistake in error.errors():
        if mistake["type"] == "missing" and mistake["loc"] in meant:
            continue
        place = (key, *mistake["loc"]) if key else mistake["loc"]
        name = printable(".".join(str(part) for part in place if part != "[key]"), 120)
        if not any(table == name or table.startswith(f"{name}.") for table in tables):
            found.append(_in_words(name, dict(mistake), model))
    return found


def _in_words(name: str, mistake: dict[str, Any], model: type[BaseModel]) -> str:
    if mistake["type"] == "missing":
        return f"{name}: is missing"
    if mistake["type"] == "extra_forbidden":
        return f"{name}: unknown key{_suggestion(mistake['loc'], model)}"
    value = mistake["input"]
    shown = "a table" if isinstance(value, dict) else printable(repr(value), 60)
    return f"{name} = {shown}: {needed(mistake)}"


def _meant(error: ValidationError, model: type[BaseModel]) -> set[tuple[int | str, ...]]:
    """Keys whose misspelling is reported: that they are missing need not be."""
    unknown = [one["loc"] for one in error.errors() if one["type"] == "extra_forbidden"]
    return {(*place[:-1], _closest(place, model)) for place in unknown}


def _suggestion(place: tuple[int | str, ...], model: type[BaseModel]) -> str:
    near = _closest(place, model)
    return f"; did you mean '{near}'?" if near else ""


def _closest(place: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """The key of the same table that may have been meant, or ''."""
    table: type[BaseModel] | None = model
    for part in place[:-1]:
        field = table.model_fields.get(str(part)) if table else None
        if field is not None:  # else the name of one of several tables of a kind
            table = _table_in(field.annotation)
    return closest(str(place[-1]), table.model_fields if table else ())


def _table_in(annotation: Any) -> type[BaseModel] | None:
    """The table that a field holds, alone, optional or several by name."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _table_in(part))), None)


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
