"""What may be varied, and what a model is with other values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from hil.analysis.campaigns._axes import GROUPS, Axis
from hil.analysis.campaigns._file import CampaignFile
from hil.analysis.tuning import ALTERNATIVES, PARAMETERS
from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.model import EffectUse, Model, model_from_dict, parameter_unit
from test_plans import Plan
from test_plans.building import PlanMistakes

Check = Callable[[float], object]


def axes_of(file: CampaignFile, plan: Plan, model: Model, *, controlled: bool) -> tuple[Axis, ...]:
    """The axes of a campaign, every value tried on its own.

    Args:
        controlled: whether a controller drives a segment of the plan.

    Raises:
        BadInputError: every name that there is not, and every value that is out of range: line, key.
    """
    document, mistakes, found = file.document, PlanMistakes(), []
    for column, values in file.vary.items():
        where = document.place(("vary", column))
        with mistakes.collected():
            group, _, name = column.partition(".")
            if group not in GROUPS or not name:
                raise BadInputError(
                    f"'{column}' does not start with a known group",
                    where=where,
                    fix=did_you_mean(f"{group}.", _shown()),
                )
            unit, check = _of_group(group, name, plan, model, controlled, where, _firsts(file, name))
            for value in values:
                _tried(check, column, value, where)
            found.append(Axis(group, name, unit, values))
    with mistakes.collected():
        _refuse_alternatives(found, file)
    mistakes.refuse()
    return tuple(found)


def _shown() -> tuple[str, ...]:
    return ("controller.NAME", "model.NAME", "effect.ID.NAME", "plan.NAME")


def _firsts(file: CampaignFile, name: str) -> dict[str, float]:
    """First values of the effect that a number belongs to: one that is new needs all of its numbers."""
    id_ = name.partition(".")[0]
    effect = EFFECTS.get(id_)
    known = () if effect is None else [f"{id_}.{one.name}" for one in effect.parameters]
    return {one: file.vary[f"effect.{one}"][0] for one in known if f"effect.{one}" in file.vary}


def _of_group(
    group: str,
    name: str,
    plan: Plan,
    model: Model,
    controlled: bool,
    where: str,
    firsts: Mapping[str, float],
) -> tuple[str, Check]:
    """Unit of what is varied, and what refuses a value of it."""
    if group == "plan":
        variable = plan.variables.get(
            _known(name, plan.variables, f"plan '{plan.name}' has no variable", where)
        )
        assert variable is not None
        return variable.unit, lambda value: _refuse(variable.objection(value))
    if group == "controller":
        if not controlled:
            raise BadInputError(f"no controller drives a segment of plan '{plan.name}'", where=where)
        known = PARAMETERS[_known(name, PARAMETERS, "a controller has no parameter", where)]
        allowed = f"give a value from {known.least:g} to {known.most:g} {known.unit}".strip()
        return known.unit, lambda value: _refuse("" if known.least <= value <= known.most else allowed)
    if group == "model":
        _known(name, model.parameters, f"a '{model.kind}' model has no parameter", where)
        return parameter_unit(name), lambda value: checked(varied(model, {name: value}, {}), where)
    id_, _, parameter = name.partition(".")
    effect = EFFECTS[_known(id_, EFFECTS, "there is no effect", where)]
    numbers = {one.name: one for one in effect.parameters}
    unit = numbers[_known(parameter, numbers, f"effect '{id_}' has no number", where)].unit
    if sum(use.id == id_ for use in model.effects) > 1:
        raise BadInputError(f"effect '{id_}' occurs several times in the model", where=where)
    return unit, lambda value: checked(varied(model, {}, {**firsts, name: value}), where)


def _known(name: str, names: Mapping[str, object], what: str, where: str) -> str:
    if name not in names:
        raise BadInputError(f"{what} '{name}'", where=where, fix=did_you_mean(name, names))
    return name


def _refuse(objection: str) -> None:
    if objection:
        raise BadInputError(objection)


def _tried(check: Check, column: str, value: float, where: str) -> None:
    try:
        check(value)
    except BadInputError as error:
        raise BadInputError(f"{column} = {value:g}: {error.what}", where=where, fix=error.fix) from None


def _refuse_alternatives(axes: list[Axis], file: CampaignFile) -> None:
    names = [axis.name for axis in axes if axis.group == "controller"]
    for one, other in ALTERNATIVES:
        first, second = ([name for name in names if name in group] for group in (one, other))
        if first and second:
            where = file.document.place(("vary", f"controller.{second[0]}"))
            raise BadInputError(
                f"{first[0]} and {second[0]} exclude each other", where=where, fix="leave one out"
            )


def varied(model: Model, parameters: Mapping[str, float], effects: Mapping[str, float]) -> Model:
    """A model with other parameters and other numbers of effects, by `ID.NAME`; a new effect comes last."""
    uses = {use.id: use for use in model.effects}
    for name, value in effects.items():
        id_, _, parameter = name.partition(".")
        own = uses[id_].values if id_ in uses else EFFECTS[id_].completed({})
        uses[id_] = EffectUse(id_, {**own, parameter: value})
    changed = {name.partition(".")[0] for name in effects}
    kept = [uses[use.id] if use.id in changed else use for use in model.effects]
    there = {use.id for use in model.effects}
    new = [use for id_, use in uses.items() if id_ not in there]
    return model.with_parameters(**parameters).with_effects(*kept, *new)


def checked(model: Model, where: str) -> Model:
    """The model, if a file could hold it.

    Raises:
        BadInputError: a value is missing or out of range.
    """
    return model_from_dict(
        {
            "kind": model.kind,
            "parameters": model.parameters,
            "effects": [{"id": use.id, **use.values} for use in model.effects],
        },
        where,
    )


def inputs_of(model: Model, names: tuple[str, ...]) -> dict[str, float]:
    """Numbers of a model by column: `model.NAME` and `effect.ID.NAME`; what it has not is 0."""
    found = {}
    for column in names:
        group, _, name = column.partition(".")
        if group == "model":
            found[column] = model.parameters[name]
        elif group == "effect":
            id_, _, parameter = name.partition(".")
            values = next((use.values for use in model.effects if use.id == id_), {})
            found[column] = float(values.get(parameter, 0.0))
    return found


def column_units(axes: Sequence[Axis], drawn: Sequence[str]) -> dict[str, str]:
    """Units of the columns of inputs: what is varied, then what differs from car to car."""
    found = {axis.column: axis.unit for axis in axes}
    for column in drawn:
        group, _, name = column.partition(".")
        id_, _, parameter = name.partition(".")
        found[column] = parameter_unit(name) if group == "model" else EFFECTS[id_].parameter(parameter).unit
    return found
