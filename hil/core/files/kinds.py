"""Which of the bench's files a table is, by its keys, and the version of its format."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, WithJsonSchema

from hil.core.errors import BadInputError

Kind = Literal["bench file", "model", "controller", "plan"]

_SIGNS: Mapping[Kind, frozenset[str]] = {
    "bench file": frozenset({"buses", "rmcu", "dyno", "simulation"}),
    "model": frozenset({"kind", "parameters", "transfer_functions"}),
    "controller": frozenset({"dfc", "wsc", "dfo"}),
    "plan": frozenset({"steps", "criteria"}),
}
_GIVEN: Mapping[Kind, str] = {
    "bench file": "give it as --bench FILE to a command that takes one, as 'hil run' does",
    "model": "give it as --model FILE, or name it under [simulation] of a bench file",
    "controller": "give it as --controller FILE, or name it in a plan's set_controller",
    "plan": "give it to 'hil check' or 'hil run' as PLAN",
}


def kind_of(data: Mapping[str, Any]) -> Kind | None:
    """What its keys say a file is, None where they say nothing or two things."""
    found: list[Kind] = [kind for kind, signs in _SIGNS.items() if signs & data.keys()]
    return found[0] if len(found) == 1 else None


def refuse_other_kind(data: Mapping[str, Any], wanted: Kind, where: str) -> None:
    """Refuse a file that is another kind than `wanted`.

    Raises:
        BadInputError: says what it is and where it belongs.
    """
    kind = kind_of(data)
    if kind not in (None, wanted):
        raise BadInputError(f"this is a {kind}; a {wanted} is needed", where=where, fix=_GIVEN[kind])


#: What this version writes, and the newest that it reads.
FORMAT = 1
FORMAT_SCHEMA = {"const": FORMAT, "default": FORMAT, "description": "version of the format of this file"}


def readable_format(value: object) -> int:
    """The number of a format that this version reads.

    Raises:
        ValueError: it is another one.
    """
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise ValueError(f"must be {FORMAT}")
    if value > FORMAT:
        raise ValueError(f"is of a newer version of this software; this one reads up to {FORMAT}")
    return value


FormatNumber = Annotated[int, BeforeValidator(readable_format), WithJsonSchema(FORMAT_SCHEMA)]
