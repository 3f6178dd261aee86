"""Options of the form NAME=VALUE."""

from __future__ import annotations

from collections.abc import Iterable

from hil.core.errors import BadInputError
from hil.core.printable import printable


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
        try:
            numbers[name] = float(value)
        except ValueError:
            raise BadInputError(
                f"'{printable(f'{name}={value}')}' has no number behind '='",
                where=option,
                fix=f"write {option} NAME=VALUE",
            ) from None
    return numbers
