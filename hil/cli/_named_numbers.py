"""Options of the form NAME=VALUE."""

from __future__ import annotations

from collections.abc import Iterable

from hil.core.errors import BadInputError


def named_numbers(given: Iterable[str], option: str) -> dict[str, float]:
    """Numbers by name; a name given twice counts the last time.

    Raises:
        BadInputError: not NAME=VALUE, or the value is no number.
    """
    numbers = {}
    for text in given:
        name, sign, value = text.partition("=")
        try:
            numbers[name.strip()] = float(value)
        except ValueError:
            raise BadInputError(
                f"'{text}' " + ("has no number behind '='" if sign else "has no '='"),
                where=option,
                fix=f"write {option} NAME=VALUE",
            ) from None
    return numbers
