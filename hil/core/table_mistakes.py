"""What is wrong with a table of a TOML file: pydantic's errors by key, value and what would be right."""

from __future__ import annotations

from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from hil.core.field_words import needed
from hil.core.mistakes import keyed
from hil.core.printable import printable
from hil.core.suggestion import closest


def mistakes_of(
    error: ValidationError, model: type[BaseModel], key: str = "", known: list[str] | None = None
) -> list[str]:
    """Each of pydantic's errors: key, value, and what would be right.

    Args:
        model: what the table should be.
        key: of the table that was checked.
        known: mistakes that were told; what is told of the same table again is left out.
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
    """Keys whose misspelling is told: that they are missing need not be."""
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
