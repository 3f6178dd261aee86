"""What a plan is."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from hil.core.files.toml_file import FORMAT, FormatNumber
from hil.core.result import VariableValue
from test_plans.building import Strict
from test_plans.conductor import PlannedSegment
from test_plans.criteria import Criterion
from test_plans.device_checks import DeviceChecks
from test_plans.pace import Pace
from test_plans.steps import Excitation, Repeat, Step
from test_plans.variables import Variable

_SAMPLE_TIME_S = 0.001
_LONGEST_SAMPLED_S = 1000.0


class PlanKeys(Strict):
    """The keys of a plan that are plain text."""

    format: FormatNumber = FORMAT
    name: str = Field(
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$",
        description="name of the results; letters, digits, _, - and ., at most 64",
    )
    title: str = Field(default="", max_length=200, description="title of the report")
    description: str = Field(default="", max_length=10_000, description="purpose of the plan")
    hazardous: bool | Annotated[str, Field(min_length=1, max_length=500)] = Field(
        default=False, description="true, or the reason; a run then needs a person's authorisation by name"
    )
    variables: dict[str, Variable] = Field(
        default={}, description="variables that a run can set, by name; use them as $name"
    )
    device: DeviceChecks = Field(
        default=DeviceChecks(), description="limits of the device checks, evaluated in every step"
    )


class Plan(PlanKeys):
    """A checked plan; `text` is its YAML as read from `source`.

    `finally_` (in YAML: `finally`) are the steps that are executed at the end, whatever happened.
    """

    steps: tuple[Step, ...] = Field(min_length=1)
    finally_: tuple[Step, ...] = ()
    criteria: tuple[Criterion, ...] = ()
    text: str
    source: Path

    @property
    def values(self) -> tuple[VariableValue, ...]:
        """What its variables are for this run."""
        chosen = self.variables.items()
        return tuple(VariableValue(name=name, value=v.default, unit=v.unit) for name, v in chosen)

    @property
    def segments(self) -> tuple[PlannedSegment, ...]:
        """The segments that the plan will produce, in order."""
        return tuple(segment for step in self.steps for segment in step.segments())

    @property
    def device_criteria(self) -> tuple[Criterion, ...]:
        """What any device must do in the plan's steps, whatever its author asks.

        One whose id a criterion of the plan has gets `device_` before its metric: each has a name of its own.
        """
        taken = {one.id for one in self.criteria}
        found = self.device.criteria(self.segments)
        return tuple(
            one.model_copy(update={"id": f"{one.segment}.device_{one.id.removeprefix(f'{one.segment}.')}"})
            if one.id in taken
            else one
            for one in found
        )

    @property
    def device_gaps(self) -> tuple[str, ...]:
        """What of that is not checked, one sentence each."""
        return self.device.gaps(self.segments)


def estimate_duration_s(plan: Plan, pace: Pace | None = None) -> float:
    """Bench time of a whole run in seconds, started at standstill, operator prompts not counted.

    Without `pace`, a bench of default pace is assumed. Running resistance is left out.
    """
    pace = pace or Pace()
    total, speed = 0.0, 0.0
    for step in (*plan.steps, *plan.finally_):
        duration, speed = step.outlook(speed, pace)
        total += duration
    return total


def largest_requests_nm(plan: Plan) -> dict[str, float]:
    """Largest magnitude of each requested torque, N m, by quantity: `driving_torque` is at the wheels.

    Steps that say no levels are sampled at 1 kHz in their first play, but those of more than 1000 s.
    """
    found: dict[str, float] = {}
    for step in _excitations(plan.steps):
        found[step.quantity] = max(found.get(step.quantity, 0.0), _largest_nm(step))
    return found


def _excitations(steps: tuple[Step, ...]) -> Iterator[Excitation]:
    for step in steps:
        if isinstance(step, Excitation):
            yield step
        elif isinstance(step, Repeat):
            yield from _excitations(step.steps)


@functools.lru_cache(1000)
def _largest_nm(step: Excitation) -> float:
    levels: list[float] = [getattr(step, name, 0.0) for name in ("from_nm", "to_nm")]
    levels += getattr(step, "levels_nm", ())
    if not any(levels) and step.play_s <= _LONGEST_SAMPLED_S:
        levels += [float(np.max(np.abs(step.samples(_SAMPLE_TIME_S, 0)), initial=0.0))]
    return max(abs(one) for one in levels)
