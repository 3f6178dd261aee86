"""What was not the same in two runs of one plan: controllers, model, bench, the plan's own values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import yaml

from hil.analysis.comparison._runs import CONTROLLERS, PLAN, ComparedRun, loaded_in_turn
from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml

Kind = Literal["controller", "model", "bench", "plan"]
_NOTHING = "–"
#: Says where a model or a controller came from, not what it is.
_NOT_COMPARED = ("meta", "format")
_LONGEST = 200


@dataclass(frozen=True)
class Difference:
    """A value of an input that two runs do not have in common; `–` where a run has none."""

    kind: Kind
    name: str
    first: str
    other: str


def differences(first: ComparedRun, other: ComparedRun) -> tuple[Difference, ...]:
    """Every value that differs in what the two were given, controllers first."""
    found = [*_of_controllers(first, other)]
    for kind, name in _FILES.items():
        found += _between(kind, "", _table(first, name), _table(other, name))
    return tuple(found)


_FILES: dict[Kind, str] = {"model": "model.toml", "bench": "bench.toml", "plan": PLAN}


def _of_controllers(first: ComparedRun, other: ComparedRun) -> Iterator[Difference]:
    """Those that the same step loaded, under whatever name, value by value."""
    for one, two in loaded_in_turn(first, other):
        name = one.removesuffix(".toml")
        if one != two:
            yield Difference("controller", "file", name, two.removesuffix(".toml"))
        yield from _between(
            "controller", f"{name}: ", _table(first, CONTROLLERS + one), _table(other, CONTROLLERS + two)
        )


def _between(kind: Kind, prefix: str, one: dict[str, str], two: dict[str, str]) -> list[Difference]:
    keys = dict.fromkeys([*one, *two])
    return [
        Difference(kind, prefix + key, one.get(key, _NOTHING), two.get(key, _NOTHING))
        for key in keys
        if one.get(key) != two.get(key)
    ]


def _table(run: ComparedRun, name: str) -> dict[str, str]:
    """Values of an attached file by dotted key; nothing where there is no such file or it cannot be read."""
    text = run.recording.attachments.get(name, b"").decode("utf-8", "replace")
    try:
        content = yaml.safe_load(text) if name == PLAN else parse_toml(text, name)
    except (yaml.YAMLError, BadInputError):
        return {}
    if not isinstance(content, dict):
        return {}
    return dict(_flat({key: value for key, value in content.items() if key not in _NOT_COMPARED}, ""))


def _flat(value: Any, path: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict) and (value or not path):
        for key, one in value.items():
            if key != "set_controller":  # compared by what is in their files
                yield from _flat(one, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and any(isinstance(one, dict) for one in value):
        for index, one in enumerate(value):
            yield from _flat(one, f"{path}[{index}]")
    else:
        yield path, str(value)[:_LONGEST]
