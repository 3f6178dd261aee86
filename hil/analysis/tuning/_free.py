"""The file that says which parameters of a controller are free, between which bounds, and what must hold."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from hil.analysis.tuning._kept import KEPT
from hil.analysis.tuning._parameters import ALTERNATIVES, PARAMETERS
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import Mistake, keyed, mistakes_of, refuse
from hil.core.errors.wording import did_you_mean
from hil.core.files.toml_file import parse_toml, toml_text
from hil.core.model import MODEL_KINDS
from test_plans import Plan

Bounds = Annotated[tuple[float, float], Field(strict=False)]  # a list of TOML; its numbers are numbers
_CHAIN = tuple(dict.fromkeys(name for names in MODEL_KINDS.values() for name in names))


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class HardLimits(_Table):
    """What must hold on the model and in every draw; None: not asked for."""

    sensitivity_peak: float | None = Field(2.0, gt=1, description="largest |S|")
    gain_margin_db: float | None = Field(6.0, gt=0)
    phase_margin_deg: float | None = Field(30.0, gt=0, lt=180)
    delay_margin_s: float | None = Field(0.001, gt=0, lt=1)
    motor_torque_nm: float | None = Field(None, gt=0, description="largest |T_m*| in a driven segment")
    motor_energy_j: float | None = Field(None, gt=0, description="positive work in a driven segment")
    no_worse_than_start: bool = Field(False, description="no criterion may lose margin, on any vehicle")


class Keep(_Table):
    """What must not get worse than with the start, on the same car, by more than a share."""

    share_percent: float = Field(5.0, ge=0, le=1000, description="largest worsening, % of the start's figure")
    may_worsen: Annotated[tuple[Literal[KEPT], ...], Field(strict=False)] = ()  # type: ignore[valid-type]


class Tolerance(_Table):
    """What differs from the model from car to car: half widths; `relative` by the model's parameters."""

    relative: dict[str, float] = {}
    dead_time_s: float = Field(0.0, ge=0, lt=0.1)
    backlash_rad: float = Field(0.0, ge=0, lt=1)
    order_phase: bool = False
    sensor_noise: float = Field(0.0, ge=0, le=100)

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """As they stand side by side in a file: parameters of models, then the others."""
        return (*_CHAIN, *(name for name in cls.model_fields if name != "relative"))

    @staticmethod
    def apart(table: dict[str, Any]) -> dict[str, Any]:
        """A file's table with the model's parameters in a table of their own, `relative`."""
        relative = {name: value for name, value in table.items() if name in _CHAIN}
        return {k: v for k, v in table.items() if k not in relative} | {"relative": relative}


class Free(_Table):
    """What a tuning may change (`free`: bounds by parameter), and what must hold.

    `weights` are by criterion id or metric; `where` is the file, for messages.
    """

    free: dict[str, Bounds] = Field(min_length=1)
    weights: dict[str, float] = {}
    limits: HardLimits = HardLimits()
    keep: Keep = Keep()
    tolerance: Tolerance = Tolerance()
    where: str = ""

    @field_validator("tolerance", mode="before")
    @classmethod
    def _parameters_apart(cls, table: Any) -> Any:
        return Tolerance.apart(table) if isinstance(table, dict) else table

    def weight(self, criterion: str, metric: str) -> float:
        """How much more a criterion matters than others."""
        return self.weights.get(criterion, self.weights.get(metric, 1.0))


def read_free(path: Path | None) -> Free:
    """What is free, from a file or as shipped.

    Raises:
        BadInputError: names every key that is unknown, out of range or contradictory.
    """
    if path is None:
        return free_from_toml(shipped_free(), "free.toml, built in")
    return free_from_toml(toml_text(path), str(path))


def shipped_free() -> str:
    """The text of the file that is used without `--free`."""
    return resources.files("hil.analysis.tuning").joinpath("free.toml").read_text("utf-8")


def free_from_toml(text: str, where: str) -> Free:
    """Check the text of such a file; `where` names it in messages.

    Raises:
        BadInputError: not TOML, or names every key that is unknown, out of range or contradictory.
    """
    data = parse_toml(text, where)
    if "where" in data:
        refuse(where, [Mistake("where", "where: unknown key")], text)
    try:
        found = Free.model_validate({**data, "where": where})
    except ValidationError as error:
        mistakes = [one.replace("tolerance.relative.", "tolerance.", 1) for one in mistakes_of(error, Free)]
        refuse(where, map(keyed, mistakes), text)
        raise
    refuse(where, [*_bounds_mistakes(found), *_weight_mistakes(found), *_tolerance_mistakes(found)], text)
    return found


def _bounds_mistakes(free: Free) -> list[Mistake]:
    mistakes = []
    for name, (low, high) in free.free.items():
        key = f"free.{name}"
        if name not in PARAMETERS:
            mistakes.append(
                Mistake(key, f"{key}: no parameter has this name", did_you_mean(name, PARAMETERS))
            )
            continue
        known = PARAMETERS[name]
        if not low < high:
            mistakes.append(
                Mistake(key, f"{key} = [{low:g}, {high:g}]: the lower bound is not below the upper one")
            )
        if low < known.least or high > known.most:
            allowed = f"{known.least:g} to {known.most:g} {known.unit}".strip()
            mistakes.append(Mistake(key, f"{key} = [{low:g}, {high:g}]: it lies from {allowed}"))
    for one, other in ALTERNATIVES:
        both = [name for names in (one, other) for name in names if name in free.free]
        if any(n in free.free for n in one) and any(n in free.free for n in other):
            mistakes.append(
                Mistake(f"free.{both[0]}", f"free: {' and '.join(both)} exclude each other", "leave one out")
            )
    return mistakes


def _weight_mistakes(free: Free) -> list[Mistake]:
    return [
        Mistake(
            f"weights.{name}", f"weights.{name} = {value:g}: a weight is a number above 0 of at most 1000"
        )
        for name, value in free.weights.items()
        if not 0 < value <= 1000
    ]


def _tolerance_mistakes(free: Free) -> list[Mistake]:
    return [
        Mistake(f"tolerance.{name}", f"tolerance.{name} = {value:g}: it lies from 0 to below 1, a share")
        for name, value in free.tolerance.relative.items()
        if not 0 <= value < 1
    ]


def refuse_unknown_weights(free: Free, plan: Plan) -> None:
    """Refuse weights of criteria that a plan has not.

    Raises:
        BadInputError: names the weight.
    """
    known = [*(c.id for c in plan.criteria), *dict.fromkeys(c.metric.name for c in plan.criteria)]
    for name in free.weights:
        if name not in known:
            raise BadInputError(
                f"weights.{name}: plan '{plan.name}' has no such criterion or metric",
                where=free.where,
                fix=did_you_mean(name, known),
            )
