"""Options of a command as the request of a use case."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, TypeVar

R = TypeVar("R")


def request_of(kind: type[R], options: object, **given: Any) -> R:
    """A request of which each field is the option of the same name, unless it is given."""
    names = {field.name for field in fields(kind)}  # type: ignore[arg-type]
    return kind(**{name: getattr(options, name) for name in names - given.keys()}, **given)
