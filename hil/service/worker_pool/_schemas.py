"""JSON schemas of the files that people write on the page."""

from __future__ import annotations

from typing import Any

from hil.app.schemas import SCHEMAS


def schema(kind: str) -> dict[str, Any]:
    """As `hil schema` prints it."""
    return SCHEMAS[kind]()
