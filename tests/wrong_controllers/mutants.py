"""Mutants of a controller file: each number times and by 2, 5, 10 and 100, each path off, files swapped."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from hil.core.controller import Controller

FACTORS = (1 / 100, 1 / 10, 1 / 5, 1 / 2, 2, 5, 10, 100)
#: Numbers that no RMCU takes otherwise, or that stand for nothing that acts.
_LEFT_OUT = {"format", "sample_time_s", "plant.denominator[0]"}
_OFF = {
    "dfc.integral_gain": "DFC's feedback off",
    "wsc.proportional_gain": "K_p off",
    "wsc.integral_gain": "K_i off",
}


@dataclass(frozen=True)
class Mutant:
    """A wrong controller: what was changed, and how; None where the file is refused."""

    what: str
    change: str
    controller: Controller | None


def mutants_of(controller: Controller, other: Controller) -> Iterator[Mutant]:
    """All mutants of a controller; `other` is the file that it may be mistaken for."""
    content = controller.model_dump(exclude_none=True)
    for path, value in numbers_in(content):
        if path in _LEFT_OUT or value == 0:
            continue
        for factor in FACTORS:
            yield Mutant(path, f"× {factor:g}", _made(content, path, value * factor))
    for path, what in _OFF.items():
        yield Mutant(path, what, _made(content, path, 0.0))
    for filter_ in ("lead", "notch"):
        if filter_ in content["wsc"]:
            bare = copy.deepcopy(content)
            del bare["wsc"][filter_]
            yield Mutant(f"wsc.{filter_}", "off", Controller.model_validate(bare))
    for normalisation in ("dc", "centre"):
        if "lead" in content["wsc"]:
            yield Mutant(
                "wsc.lead.normalisation",
                normalisation,
                _made(content, "wsc.lead.normalisation", normalisation),
            )
    yield Mutant("file", "the other one", other)


def numbers_in(content: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float]]:
    """Every number of a file with its path."""
    for key, value in content.items():
        path = f"{above}{key}"
        if isinstance(value, Mapping):
            yield from numbers_in(value, f"{path}.")
        elif isinstance(value, tuple | list):
            yield from ((f"{path}[{place}]", float(one)) for place, one in enumerate(value))
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield path, float(value)


def _made(content: Mapping[str, Any], path: str, value: object) -> Controller | None:
    changed = copy.deepcopy(dict(content))
    *parents, last = path.split(".")
    table = changed
    for parent in parents:
        table = table[parent]
    name, _, place = last.partition("[")
    if place:
        several = list(table[name])
        several[int(place[:-1])] = value
        table[name] = tuple(several)
    else:
        table[name] = value
    try:
        return Controller.model_validate(changed)
    except ValidationError:
        return None
