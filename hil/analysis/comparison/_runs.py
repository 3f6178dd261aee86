"""Runs that are compared, and which of their inputs differ."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import yaml

from hil.analysis.comparison._plan_values import PlanValue, plan_groups
from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml
from hil.core.recording import Recording
from hil.core.result import RunResult

PLAN = "plan.yaml"
CONTROLLERS = "controller/"
_STEP, _FILE = "set_controller", "file"


@dataclass(frozen=True)
class ComparedRun:
    """A run under the name that tables and figures give it; `result` has its criteria."""

    name: str
    recording: Recording
    result: RunResult


def names_by_variables(folders: Sequence[str], results: Sequence[RunResult]) -> list[str]:
    """What to call each run: the variables of the plan in which they differ, or else their folders.

    Variables are the better name where they tell every run from every other: 'torque_nm = 100 N m'.
    """
    values = [{one.name: str(one) for one in result.variables} for result in results]
    every = dict.fromkeys(name for run in values for name in run)
    differing = [name for name in every if len({run.get(name) for run in values}) > 1]
    names = [", ".join(run[name] for name in differing if name in run) for run in values]
    return names if all(names) and len(set(names)) == len(names) else list(folders)


def controllers_that_differ(runs: Sequence[ComparedRun]) -> tuple[str, ...]:
    """Names of controllers of which some run had another version than the first, or loaded elsewhere."""
    first = _controllers(runs[0].recording)
    differing: set[str] = set()
    for run in runs[1:]:
        other = _controllers(run.recording)
        differing |= {name for name in first | other if first.get(name) != other.get(name)}
        differing |= {name for pair in loaded_in_turn(runs[0], run) if len(set(pair)) > 1 for name in pair}
    return tuple(sorted(differing))


def loaded_in_turn(first: ComparedRun, other: ComparedRun) -> tuple[tuple[str, str], ...]:
    """Names of the controllers that each step of the plan loaded in both runs, in the plan's order."""
    pairs = zip(_loaded(_plan_of(first.recording)), _loaded(_plan_of(other.recording)), strict=False)
    return tuple(dict.fromkeys((Path(one).name, Path(two).name) for one, two in pairs))


def _controllers(recording: Recording) -> dict[str, bytes]:
    return {
        name.removeprefix(CONTROLLERS): content
        for name, content in recording.attachments.items()
        if name.startswith(CONTROLLERS)
    }


def _loaded(value: object) -> Iterator[str]:
    """Files that steps load, also steps within steps."""
    if isinstance(value, dict):
        loaded = value.get(_STEP)
        if isinstance(loaded, dict) and isinstance(loaded.get(_FILE), str):
            yield loaded[_FILE]
        yield from _loaded(list(value.values()))
    elif isinstance(value, list):
        for one in value:
            yield from _loaded(one)


def _plan_of(recording: Recording) -> dict[str, Any]:
    try:
        content = yaml.safe_load(recording.attachments.get(PLAN, b"").decode())
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise BadInputError(
            f"its {PLAN} cannot be read", where=str(recording.source), fix="use another copy"
        ) from error
    if not isinstance(content, dict):
        raise BadInputError(
            f"has no {PLAN}", where=str(recording.source), fix="compare recordings of hil run"
        )
    return content


Kind = Literal["controller", "model", "bench", "plan"]
_NOTHING = "–"
_NO_VALUE = PlanValue(_NOTHING, shown=_NOTHING)
#: Says where a model or a controller came from, not what it is.
_NOT_COMPARED = ("meta", "format")
_LONGEST = 200
#: Of a plan: called otherwise, not otherwise done.
_NAMES = ("name", "title", "description")
_SHOWN = 4  # differences of a plan in a sentence; tables have all


@dataclass(frozen=True)
class Difference:
    """A value of an input that two runs do not have in common; `–` where a run has none.

    `unit` is that of both, '' where the input says none.
    """

    kind: Kind
    name: str
    first: str
    other: str
    unit: str = ""

    def __str__(self) -> str:
        """'segment s (step): to_nm 200 N m instead of 180 N m'."""
        if self.first == _NOTHING:
            return f"{self.name} is only in it"
        if self.other == _NOTHING:
            return f"{self.name} is not in it"
        values = (f"{value} {self.unit}".rstrip() for value in (self.other, self.first))
        return f"{self.name} {' instead of '.join(values)}"


def differences(first: ComparedRun, other: ComparedRun) -> tuple[Difference, ...]:
    """Every value that differs in what the two were given, controllers first."""
    found = [*_of_controllers(first, other)]
    for kind, name in _FILES.items():
        found += _between(kind, "", _table(first, name), _table(other, name))
    return (*found, *_of_plans(first, other))


_FILES: dict[Kind, str] = {"model": "model.toml", "bench": "bench.toml"}


@dataclass(frozen=True)
class PlanSummary:
    """How the other's plan differs, for a sentence: the first values, and how many more there are."""

    shown: tuple[Difference, ...]
    more: int


def plan_summary(first: ComparedRun, other: ComparedRun) -> PlanSummary:
    """What the other's plan does or demands otherwise, whatever it is called."""
    found = tuple(one for one in _of_plans(first, other) if one.name not in _NAMES)
    return PlanSummary(found[:_SHOWN], max(0, len(found) - _SHOWN))


def _of_plans(first: ComparedRun, other: ComparedRun) -> Iterator[Difference]:
    """By segment and kind, and by criterion: a step more or less moves no other; a whole one is one line."""
    one, two = plan_groups(_content(first, PLAN)), plan_groups(_content(other, PLAN))
    for group in dict.fromkeys([*one, *two]):
        if group not in one or group not in two:
            yield Difference("plan", group, _in_words(one.get(group)), _in_words(two.get(group)))
            continue
        of_first, of_other = one[group], two[group]
        for name in dict.fromkeys([*of_first, *of_other]):
            mine, its = of_first.get(name, _NO_VALUE), of_other.get(name, _NO_VALUE)
            if mine != its:
                label = f"{group}: {name}" if group else name
                yield Difference("plan", label, mine.shown, its.shown, mine.unit or its.unit)


def _in_words(group: dict[str, PlanValue] | None) -> str:
    if group is None:
        return _NOTHING
    return ", ".join(f"{name} {value.shown}" for name, value in group.items())[:_LONGEST] or "there"


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
    return dict(_flat(_content(run, name), ""))


def _content(run: ComparedRun, name: str) -> dict[str, Any]:
    """An attached file, without what says where it came from; empty where it cannot be read."""
    text = run.recording.attachments.get(name, b"").decode("utf-8", "replace")
    try:
        content = yaml.safe_load(text) if name == PLAN else parse_toml(text, name)
    except (yaml.YAMLError, BadInputError):
        return {}
    if not isinstance(content, dict):
        return {}
    return {str(key): value for key, value in content.items() if key not in _NOT_COMPARED}


def _flat(value: Any, path: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict) and (value or not path):
        for key, one in value.items():
            yield from _flat(one, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and any(isinstance(one, dict) for one in value):
        for index, one in enumerate(value):
            yield from _flat(one, f"{path}[{index}]")
    else:
        yield path, str(value)[:_LONGEST]
