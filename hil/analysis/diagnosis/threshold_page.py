"""The page of all thresholds, docs/reference/thresholds.md, from where they stand."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType
from typing import Any, get_type_hints

from hil.analysis.diagnosis.data import thresholds as of_data
from hil.analysis.diagnosis.findings import thresholds as of_findings
from hil.analysis.diagnosis.threshold import CHECKS, Means

_ROOMS = {"data": of_data, "findings": of_findings}
_HEAD = """# Thresholds of the diagnosis

Made by `.venv/bin/python -m hil.analysis.diagnosis.threshold_page` from `thresholds.py` of each room; a test
compares. They are heuristics: what each decides, and which check shows if a changed one is still right.
Sizes at which effects are tried, and how far fits move them, stand with the effects (`hil/core/effects`).

| check | command |
|---|---|
"""


def thresholds(room: ModuleType) -> Iterator[tuple[str, Any, Means]]:
    """Name, value and meaning of every threshold of a room."""
    for name, hint in get_type_hints(room, include_extras=True).items():
        yield name, getattr(room, name), hint.__metadata__[0]


def page() -> str:
    """The page as Markdown."""
    parts = [_HEAD + "".join(f"| {name} | `{command}` |\n" for name, command in CHECKS.items())]
    for name, room in _ROOMS.items():
        rows = [
            f"| `{threshold}` | {_shown(value)} | {means.unit} | {means.decides} | {means.checked_by} |\n"
            for threshold, value, means in thresholds(room)
        ]
        head = f"\n## {name}\n\n| name | value | unit | decides | check |\n|---|---|---|---|---|\n"
        parts.append(head + "".join(rows))
    return "".join(parts)


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_shown, value))})"
    if isinstance(value, dict):
        return ", ".join(f"{name} {_shown(each)}" for name, each in value.items())
    return f"{value:.6g}"


if __name__ == "__main__":
    print(page(), end="")
