"""Which files a plan loads."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel

from test_plans import Plan


def files_of(value: object) -> Iterator[Path]:
    """All files that a plan's steps name, also steps within steps."""
    if isinstance(value, Path):
        yield value
    elif isinstance(value, Plan):
        yield from files_of((value.steps, value.finally_))
    elif isinstance(value, BaseModel):
        for name in type(value).model_fields:
            yield from files_of(getattr(value, name))
    elif isinstance(value, list | tuple):
        for one in value:
            yield from files_of(one)
    elif isinstance(value, dict):
        yield from files_of(list(value.values()))
