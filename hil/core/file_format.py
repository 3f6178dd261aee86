"""The format of files that outlive a version: `format = 1` says how one is read, and is the default."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, WithJsonSchema

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
