"""Values of a plan under names that stay when steps are added: those of segments and criteria."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from hil.core.channels import unit_of

_STEPS, _CRITERIA, _VARIABLES = ("steps", "finally"), "criteria", "variables"
_CONTROLLER = "set_controller"  # compared by what is in its file
_LONGEST = 200


@dataclass(frozen=True)
class PlanValue:
    """A value as it stands in a plan; `unit` is '' where neither its name nor the plan says one.

    `shown` has a variable's value before its name.
    """

    text: str
    unit: str = ""
    shown: str = field(default="", compare=False)


#: By what they belong to ('segment tip_in (step)', 'criterion tip_in.peak', '' for the rest), then by name.
PlanGroups = dict[str, dict[str, PlanValue]]


def plan_groups(content: dict[str, Any]) -> PlanGroups:
    """Values of a plan, steps by segment and kind, criteria by segment and metric; without controllers."""
    found: PlanGroups = {"": {}}
    count: Counter[str] = Counter()
    for key, value in content.items():
        if key in _STEPS and isinstance(value, list):
            for kind, step in _steps(value):
                _add(found, count, _step_name(key, kind, step), step)
        elif key == _CRITERIA and isinstance(value, list):
            for one in value:
                if isinstance(one, dict):
                    _add(found, count, _criterion_name(one), one)
        elif key == _VARIABLES and isinstance(value, dict):
            for name, one in value.items():
                fields = one if isinstance(one, dict) else {"default": one}
                found[""] |= _values(f"{_VARIABLES}.{name}.", fields, str(fields.get("unit") or ""))
        else:
            found[""] |= _values("", {key: value}, "")
    chosen = {f"${name.split('.')[1]}": one.text for name, one in found[""].items() if _is_default(name)}
    return {
        group: {name: replace(one, shown=_shown(one.text, chosen)) for name, one in fields.items()}
        for group, fields in found.items()
    }


def _is_default(name: str) -> bool:
    return name.startswith(f"{_VARIABLES}.") and name.endswith(".default") and name.count(".") == 2


def _shown(text: str, chosen: dict[str, str]) -> str:
    return f"{chosen[text]} ({text})" if text in chosen else text


def _add(found: PlanGroups, count: Counter[str], name: str, fields: dict[str, Any]) -> None:
    """Under its name, with a number behind those that have a segment in common or none."""
    count[name] += 1
    name = name if count[name] == 1 else f"{name} {count[name]}"
    found[name] = _values("", fields, str(fields.get("unit") or ""))


def _steps(steps: list[Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Kind and fields of each step, also of steps within steps."""
    for step in steps:
        if isinstance(step, str):
            yield step, {}
        elif isinstance(step, dict):
            for kind, fields in step.items():
                if kind == _CONTROLLER:
                    continue
                own = fields if isinstance(fields, dict) else {"value": fields}
                yield str(kind), {name: one for name, one in own.items() if name != "steps"}
                if isinstance(own.get("steps"), list):
                    yield from _steps(own["steps"])


def _step_name(part: str, kind: str, fields: dict[str, Any]) -> str:
    if fields.get("segment"):
        return f"segment {fields['segment']} ({kind})"
    return kind if part == "steps" else f"{part} {kind}"


def _criterion_name(fields: dict[str, Any]) -> str:
    what = ".".join(str(fields[name]) for name in ("segment", "metric", "channel") if fields.get(name))
    return f"criterion {what}"


def _values(prefix: str, fields: dict[str, Any], unit: str) -> dict[str, PlanValue]:
    return {
        name: PlanValue(text, (unit_of(name) or unit) if is_number else "")
        for name, text, is_number in _flat(fields, prefix)
    }


def _flat(value: Any, path: str) -> Iterator[tuple[str, str, bool]]:
    """Dotted name, text, and whether it is a number or a list of numbers."""
    if isinstance(value, dict):
        for key, one in value.items():
            nested = isinstance(one, dict) and bool(one)
            yield from _flat(one, f"{path}{key}" + ("." if nested else ""))
    elif isinstance(value, list) and any(isinstance(one, dict) for one in value):
        for index, one in enumerate(value):
            yield from _flat(one, f"{path}[{index}].")
    else:
        each = value if isinstance(value, list) else [value]
        numbers = all(isinstance(one, int | float) and not isinstance(one, bool) for one in each)
        variable = isinstance(value, str) and value.startswith("$")
        yield path, str(value)[:_LONGEST], numbers or variable
