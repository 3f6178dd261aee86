"""Variables of a plan: numbers with a unit and bounds that a person may choose for one run.

`variables` names them; anywhere else `$name` stands for the number, and `${name}` in a text for its digits.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from typing import Any, Self

from pydantic import Field, model_validator

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from test_plans.building import Strict, brief, build, mapping_at
from test_plans.mistakes import PlanMistakes
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
