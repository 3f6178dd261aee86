"""What a search is to reach: figures of a plan's criteria, and conditions that must hold meanwhile."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hil.core.channels import OUTPUTS
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.files.shipped import shipped_file
from hil.core.files.toml_file import parse_toml, toml_text
from hil.core.model import Model, load_model
from test_plans import Plan, load_plan

Range = tuple[float, float]


class _Keys(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class _ResponseKeys(_Keys):
    functions: Path
    plan: str = "identification"
    segments: tuple[str, ...] = ()
    within: dict[str, tuple[float, float]]


class _FileKeys(_Keys):
    plan: str = "acceptance"
    tolerance: float = Field(default=0.05, gt=0, lt=1)
    first_seconds: float | None = Field(default=None, gt=0)
    targets: dict[str, float] = {}
    settles: dict[str, float] = {}
    open: dict[str, tuple[float, float]] = {}
    response: _ResponseKeys | None = None


@dataclass(frozen=True)
class ResponseTarget:
    """The frequency response that an identification run must return.

    Args:
        functions: a transfer-function model.
        plan, segments: the run, and its segments that are looked at; none: every chirp and multisine.
        within: by output, the largest rms misfit over 0.05-30 Hz in dB and in degrees.
    """

    functions: Model
    plan: Plan
    segments: tuple[str, ...]
    within: Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class Targets:
    """Figures to reach within `tolerance` (relative), and what must hold.

    Args:
        plan: its criteria that compare two segments must hold as well.
        values: criterion id: figure, in the criterion's unit.
        first_seconds: the figures must be reached within these seconds after the step; None: any time.
        settles: segment: seconds after which T_s stays within 5 % of the step around its mean, until 4 s.
        open: RMCU parameter: range, for numbers of the controller that no one has given.
        response: None: no identification is asked for.
    """

    plan: Plan
    values: Mapping[str, float]
    tolerance: float = 0.05
    first_seconds: float | None = None
    settles: Mapping[str, float] = field(default_factory=dict)
    open: Mapping[str, Range] = field(default_factory=dict)
    response: ResponseTarget | None = None


def read_targets(path: Path | None, plan: str | None, further: Mapping[str, float]) -> Targets:
    """Targets from a file, from `further` ones by criterion that add to or replace them, or from both.

    Raises:
        BadInputError: what is unknown, missing or no number; names file and key.
    """
    keys = _keys_of(path) if path else _FileKeys()
    values = {**keys.targets, **further}
    loaded = load_plan(plan or keys.plan)
    where = str(path) if path else "--target"
    if not values:
        raise BadInputError("no target is given", where=where, fix="add --target ID=VALUE, or a targets file")
    _refuse_unknown(values, [c.id for c in loaded.criteria if not c.below], "criterion", where)
    _refuse_unknown(keys.settles, [s.id for s in loaded.segments], "segment", where)
    steps = [s.id for s in loaded.segments if s.reference_after != s.reference_before]
    for name in keys.settles:
        if name not in steps:
            fix = f"name a step: {', '.join(steps) or 'this plan has none'}"
            raise BadInputError(f"settles.{name}: that segment is not a step", where=where, fix=fix)
    for name, value in values.items():
        if not value > 0:
            raise BadInputError(f"target '{name}' is {value:g}", where=where, fix="give a positive figure")
    for name, (low, high) in keys.open.items():
        if not 0 < low < high:
            raise BadInputError(
                f"open.{name} runs from {low:g} to {high:g}",
                where=where,
                fix="give two positive, rising numbers",
            )
    found = Targets(loaded, values, keys.tolerance, keys.first_seconds, keys.settles, keys.open)
    return replace(found, response=_response(keys.response, path)) if keys.response and path else found


def _keys_of(path: Path) -> _FileKeys:
    data: dict[str, Any] = parse_toml(toml_text(path), str(path))
    known = _FileKeys.model_fields
    for key in data:
        if key not in known:
            raise BadInputError(f"unknown key '{key}'", where=str(path), fix=did_you_mean(key, known))
    try:
        return _FileKeys.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise BadInputError(
            f"{key}: {first['msg']}", where=str(path), fix="see docs/how-to/explain.md"
        ) from error


def _response(keys: _ResponseKeys, path: Path) -> ResponseTarget:
    where = str(path)
    _refuse_unknown(keys.within, OUTPUTS, "output", where)
    functions = load_model(shipped_file(keys.functions, "model", path.parent))
    for name in keys.within:
        if name not in functions.transfer_functions:
            raise BadInputError(f"has no transfer function of '{name}'", where=str(keys.functions))
    plan = load_plan(keys.plan)
    _refuse_unknown(keys.segments, [s.id for s in plan.segments], "segment", where)
    return ResponseTarget(functions, plan, keys.segments, keys.within)


def _refuse_unknown(names: Iterable[str], known: Iterable[str], what: str, where: str) -> None:
    choices = list(known)
    for name in names:
        if name not in choices:
            raise BadInputError(
                f"no {what} has the name '{name}'", where=where, fix=did_you_mean(name, choices)
            )
