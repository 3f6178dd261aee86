"""What the options of a command give: values by name, and the request of a use case."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import fields
from typing import Any, TypeVar

from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from test_plans.yaml_document import FLOAT


def named_values(given: Iterable[str], option: str, *, form: str = "NAME=VALUE") -> dict[str, str]:
    """Values by name, in the order given.

    Args:
        form: what is to be written, for the message.

    Raises:
        BadInputError: no '=' in it, or a name stands twice.
    """
    values: dict[str, str] = {}
    for text in given:
        name, sign, value = text.partition("=")
        if not sign:
            raise BadInputError(f"'{printable(text)}' has no '='", where=option, fix=f"write {option} {form}")
        name = name.strip()
        if name in values:
            raise BadInputError(
                f"'{printable(name)}' is given twice", where=option, fix=f"give {option} once for each name"
            )
        values[name] = value.strip()
    return values


def named_numbers(given: Iterable[str], option: str) -> dict[str, float]:
    """Numbers by name.

    Raises:
        BadInputError: not NAME=VALUE, a name stands twice, or the value is no number.
    """
    numbers = {}
    for name, value in named_values(given, option).items():
        number = number_of(value)
        if number is None:
            raise BadInputError(
                f"'{printable(f'{name}={value}')}' has no number behind '='",
                where=option,
                fix=f"write {option} NAME=VALUE",
            )
        numbers[name] = number
    return numbers


def number_of(text: str) -> float | None:
    """A finite number as a plan would write it; None of anything else."""
    number = float(text) if FLOAT.fullmatch(text) else math.inf
    return number if math.isfinite(number) else None


R = TypeVar("R")


def request_of(kind: type[R], options: object, **given: Any) -> R:
    """A request of which each field is the option of the same name, unless it is given."""
    names = {field.name for field in fields(kind)}  # type: ignore[arg-type]
    return kind(**{name: getattr(options, name) for name in names - given.keys()}, **given)
