"""Variables of a plan: numbers with a unit and bounds that a person may choose for one run.

`variables` names them; anywhere else `$name` stands for the number, and `${name}` in a text for its digits.

What a person chooses for one run of a plan; the plan's text then says so, as if it had been written so.
"""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from pydantic import Field, model_validator

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable
from test_plans.building import PlanMistakes, Strict, brief, build, mapping_at
from test_plans.yaml_document import Document, KeyPath

KEY = "variables"
NAME = r"[A-Za-z][A-Za-z0-9_]{0,63}"
EXAMPLE = "{default: 250, unit: N m, lower: 0, upper: 300}"
_WHOLE = re.compile(rf"\$(?:({NAME})|\{{({NAME})\}})")
_WITHIN = re.compile(rf"\$\{{({NAME})\}}")


class Variable(Strict):
    """A variable that a run can set."""

    default: float = Field(description="default value, in its unit")
    unit: str = Field(default="", max_length=20, description="unit, for display only")
    lower: float | None = Field(default=None, description="smallest allowed value")
    upper: float | None = Field(default=None, description="largest allowed value")
    description: str = Field(default="", max_length=200, description="purpose")

    @model_validator(mode="after")
    def _default_is_within(self) -> Self:
        objection = self.objection(self.default)
        if objection:
            raise ValueError(f"default = {objection}")
        return self

    def objection(self, value: float) -> str:
        """Why it may not have a value; empty if it may."""
        unit = f" {self.unit}" if self.unit else ""
        if self.lower is not None and value < self.lower:
            return f"{value:g}{unit} is below the smallest allowed value, {self.lower:g}{unit}"
        if self.upper is not None and value > self.upper:
            return f"{value:g}{unit} is above the largest allowed value, {self.upper:g}{unit}"
        return ""


def variables_at(value: object, document: Document) -> dict[str, Variable]:
    """Make the variables that stand in a plan.

    Raises:
        BadInputError: line and key of every mistake.
    """
    mistakes, found = PlanMistakes(), {}
    for name, entry in mapping_at(value, document, (KEY,), f"torque_nm: {EXAMPLE}").items():
        path: KeyPath = (KEY, name)
        with mistakes.collected():
            if not re.fullmatch(NAME, name):
                raise BadInputError(
                    f"{brief(name)} is not a valid name",
                    where=document.place(path),
                    fix="letters, digits and _, a letter first",
                )
            found[name] = build(Variable, mapping_at(entry, document, path, EXAMPLE), document, path)
    mistakes.refuse()
    return found


def with_values(document: Document) -> Document:
    """The document with the default of each variable where its name stands.

    Raises:
        BadInputError: every name that is no variable's.
    """
    content = document.value
    if not isinstance(content, dict) or not isinstance(content.get(KEY), dict):
        return document
    values = {name: _default(entry) for name, entry in content[KEY].items()}
    mistakes = PlanMistakes()
    filled = {
        key: value if key == KEY else _filled(value, values, document, (key,), mistakes)
        for key, value in content.items()
    }
    mistakes.refuse()
    return dataclasses.replace(document, value=filled)


def _default(entry: object) -> object:
    """What a variable that is not sound yet stands for is reported where the variable stands."""
    return entry.get("default", 0) if isinstance(entry, dict) else 0


def _filled(
    value: Any, values: Mapping[str, object], document: Document, path: KeyPath, mistakes: PlanMistakes
) -> Any:
    if isinstance(value, dict):
        return {k: _filled(v, values, document, (*path, k), mistakes) for k, v in value.items()}
    if isinstance(value, list):
        return [_filled(v, values, document, (*path, n), mistakes) for n, v in enumerate(value)]
    if not isinstance(value, str) or "$" not in value:
        return value
    whole = _WHOLE.fullmatch(value)
    names = [whole[1] or whole[2]] if whole else _WITHIN.findall(value)
    for name in names:
        if name not in values:
            with mistakes.collected():
                fix = did_you_mean(name, values)
                raise BadInputError(f"there is no variable '{name}'", where=document.place(path), fix=fix)
    if any(name not in values for name in names):
        return value
    if whole:
        return values[names[0]]
    return _WITHIN.sub(lambda found: _digits(values[found[1]]), value)


def _digits(value: object) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)


_STEP, _FILE = "set_controller", "file"


@dataclass(frozen=True)
class Choices:
    """What replaces what a plan says.

    Attributes:
        controllers: controller files by the plan's name for what each replaces; '' for the only one.
        values: of the plan's variables, by name.
    """

    controllers: Mapping[str, Path] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)

    def applied(self, text: str, document: Document) -> str:
        """The plan's text with everything that was chosen in its place.

        Raises:
            BadInputError: the plan has nothing of that name, or a value is beyond a variable's bounds.
        """
        changes = dict(_controllers(document, self.controllers))
        changes |= dict(_values(document, self.values))
        for start, end in sorted(changes, reverse=True):
            text = text[:start] + changes[start, end] + text[end:]
        return text


def controller_choices(given: list[str], option: str) -> dict[str, Path]:
    """Controller files as given on a command line: FILE, or NAME=FILE.

    Raises:
        BadInputError: there is no such file.
    """
    chosen: dict[str, Path] = {}
    for text in given:
        name, sign, file = text.partition("=")
        if not sign or Path(text).is_file():  # its own name may have a '='
            name, file = "", text
        if not Path(file).is_file():
            raise BadInputError(
                f"there is no file '{printable(file, 200)}'",
                where=option,
                fix="give a controller file, or NAME=FILE with the name that the plan has for it",
            )
        if name in chosen:
            raise BadInputError(f"{option} is given twice for the same controller", fix="give it once")
        chosen[name] = Path(file)
    return chosen


def named_controllers(document: Document) -> dict[KeyPath, str]:
    """What a plan calls the controller files that it loads, by where it says so."""
    return dict(_named(document.value, ()))


def _values(document: Document, chosen: Mapping[str, float]) -> Iterator[tuple[tuple[int, int], str]]:
    """Places of variables' defaults in the text, with the numbers that come there."""
    content = document.value
    known = content.get(KEY) if isinstance(content, dict) else None
    for name, value in chosen.items():
        if not isinstance(known, dict) or name not in known:
            raise BadInputError(
                f"has no variable '{printable(name, 60)}'",
                where=document.where,
                fix=did_you_mean(name, known if isinstance(known, dict) else ()),
            )
        path: KeyPath = (KEY, name)
        variable = build(Variable, mapping_at(known[name], document, path, EXAMPLE), document, path)
        whole = isinstance(known[name]["default"], int) and float(value).is_integer()
        objection = variable.objection(value)
        if objection:
            raise BadInputError(f"{name} = {objection}", where=document.place(path))
        yield document.spans[*path, "default"], repr(int(value) if whole else float(value))


def _controllers(document: Document, chosen: Mapping[str, Path]) -> Iterator[tuple[tuple[int, int], str]]:
    """Places of controller files' names in the text, with the names that come there."""
    if not chosen:
        return
    places = dict(_named(document.value, ()))
    names = list(dict.fromkeys(places.values()))
    for name in chosen:
        if not names:
            raise BadInputError(
                "loads no controller file", where=document.where, fix="leave --controller out"
            )
        if not name and len(names) > 1:
            raise BadInputError(
                f"loads {len(names)} controllers: {', '.join(names)}",
                where=document.where,
                fix=f"select the one to replace: --controller {names[0]}={chosen[name]}",
            )
        if name and name not in names:
            raise BadInputError(
                f"loads no controller '{printable(name, 60)}'",
                where=document.where,
                fix=did_you_mean(name, names),
            )
    for path, name in places.items():
        file = chosen.get(name, chosen.get(""))
        if file is not None:
            yield document.spans[path], json.dumps(str(file.resolve()), ensure_ascii=False)


def _named(value: object, path: KeyPath) -> Iterator[tuple[KeyPath, str]]:
    """Where `set_controller` names a file, also within other steps."""
    if isinstance(value, dict):
        loaded = value.get(_STEP)
        if isinstance(loaded, dict) and isinstance(loaded.get(_FILE), str):
            yield (*path, _STEP, _FILE), loaded[_FILE]
        for key, item in value.items():
            yield from _named(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _named(item, (*path, index))
