"""Where in the text of a TOML file a key stands; TOML's reader does not say."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping

_HEADER = re.compile(r"^\s*\[\s*([^\[\]]+?)\s*\]\s*(?:#.*)?$")
_ENTRY = re.compile(r"^\s*\[\[\s*([^\[\]]+?)\s*\]\]\s*(?:#.*)?$")
_KEY = re.compile(r"""^\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"|'[^']*'))*)\s*=""")
_PART = re.compile(r"""[\w-]+|"[^"]*"|'[^']*'""")


def line_of(text: str, key: str) -> int | None:
    """Line of a dotted key, or of the nearest around it; None if none has a line."""
    return nearest(lines_of(text), key)


def nearest(lines: Mapping[str, int], key: str) -> int | None:
    """Line of a dotted key of `lines_of`, or of the nearest around it; None if none has one."""
    while key and key not in lines:
        key = key.rpartition(".")[0]
    return lines.get(key)


def lines_of(text: str) -> dict[str, int]:
    """Line of each dotted key (`effects[2].id` in the second of several tables).

    What stands inside of an inline table or of a text over several lines may be missed.
    """
    lines: dict[str, int] = {}
    table = ""
    entries: Counter[str] = Counter()
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = _dotted(header[1])
            lines.setdefault(table, number)
        elif entry := _ENTRY.match(line):
            name = _dotted(entry[1])
            entries[name] += 1
            table = f"{name}[{entries[name]}]"
            lines.setdefault(name, number)
            lines[table] = number
        elif found := _KEY.match(line):
            name = _dotted(found[1])
            lines.setdefault(f"{table}.{name}" if table else name, number)
    return lines


def _dotted(name: str) -> str:
    return ".".join(part.strip("\"'") for part in _PART.findall(name))
