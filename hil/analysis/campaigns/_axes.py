"""What a campaign varies: values as lists or ranges, and which simulation has which.

Each combination has one number, the same whoever simulates it and when.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field

from hil.core.errors import BadInputError
from test_plans.building import PlanMistakes, Strict, brief, build, list_at, mapping_at
from test_plans.yaml_document import Document, KeyPath

#: Beyond it the table of results no longer fits the memory of a small machine.
MOST_SIMULATIONS = 1_000_000
MOST_VALUES = 100_000
_EXAMPLE = "[20, 30, 40], or {from: 20, to: 40, count: 5}"
_LONGEST_NUMBER = 15  # digits that are written out


class Span(Strict):
    """Evenly spaced values, ends included; `scale: log` spaces their logarithms."""

    from_: float = Field(alias="from", description="first value")
    to: float = Field(description="last value")
    count: int = Field(ge=2, le=MOST_VALUES, description="number of values, both ends included")
    scale: Literal["linear", "log"] = Field(
        default="linear", description="even spacing of the values or of their logarithms"
    )

    def __len__(self) -> int:
        return self.count

    def values(self, document: Document, name: str) -> tuple[float, ...]:
        """The values of what is varied by `name`.

        Raises:
            BadInputError: they do not differ, or lie too far from each other for a number; line, key.
        """
        space = np.geomspace if self.scale == "log" else np.linspace
        with np.errstate(over="ignore", invalid="ignore"):
            found = tuple(float(f"{value:.12g}") for value in space(self.from_, self.to, self.count))
        what = ""
        if not all(map(math.isfinite, found)):
            what = f"{self.from_:g} to {self.to:g} exceeds the range of numbers, 1.8e308"
        elif len(set(found)) < len(found):
            what = f"{self.count} values from {self.from_:g} to {self.to:g} do not differ in 12 digits"
        if what:
            where = document.place(("vary", name))
            raise BadInputError(what, where=where, fix=f"write: {_EXAMPLE}")
        return found


def spans_at(value: object, document: Document) -> dict[str, Span | tuple[float, ...]]:
    """What a campaign file varies by name: values, or a range whose values are not made yet.

    Raises:
        BadInputError: all that is wrong with it: line, key, and what to do.
    """
    example = "model.vehicle_inertia: {from: 200, to: 400, count: 5}"
    table = {} if value is None else mapping_at(value, document, ("vary",), example)
    mistakes, found = PlanMistakes(), {}
    for name, entry in table.items():
        with mistakes.collected():
            path: KeyPath = ("vary", name)
            found[name] = (
                _span(entry, document, path) if isinstance(entry, dict) else _listed(entry, document, path)
            )
    mistakes.refuse()
    return found


def _span(entry: dict[str, object], document: Document, path: KeyPath) -> Span:
    span = build(Span, entry, document, path)
    if span.scale == "log" and min(span.from_, span.to) <= 0:
        raise BadInputError(
            "a logarithm needs values above 0",
            where=document.place(path),
            fix="from and to above 0, or scale: linear",
        )
    return span


def _listed(entry: object, document: Document, path: KeyPath) -> tuple[float, ...]:
    numbers = list_at(entry, document, path, _EXAMPLE)
    if len(numbers) > MOST_VALUES:
        what = f"{len(numbers)} values, at most {MOST_VALUES} are taken"
        raise BadInputError(what, where=document.place(path), fix="give fewer of them")
    for index, number in enumerate(numbers):
        plain = isinstance(number, int | float) and not isinstance(number, bool)
        if not plain or not math.isfinite(number):
            where = document.place((*path, index))
            raise BadInputError(f"{brief(number)} is not a number", where=where, fix=f"write: {_EXAMPLE}")
    if not 0 < len(set(numbers)) == len(numbers):
        what = "a value is given twice" if numbers else "there are no values"
        raise BadInputError(what, where=document.place(path), fix=f"write: {_EXAMPLE}")
    return tuple(float(number) for number in numbers)


def refuse_too_many(
    spans: Mapping[str, Span | tuple[float, ...]], controllers: int, draws: int, document: Document
) -> None:
    """Refuse a file of too many simulations, before values are made or tried.

    Raises:
        BadInputError: says how many they are, what of, and what to do.
    """
    factors = {f"values of {name}": len(span) for name, span in spans.items()}
    factors |= {"controllers": max(1, controllers), "cars": max(1, draws)}
    count = math.prod(factors.values())
    if count > MOST_SIMULATIONS:
        shown = str(count) if count < 10**_LONGEST_NUMBER else f"about 1e{math.log10(count):.0f}"
        largest = sorted(((many, name) for name, many in factors.items() if many > 1), reverse=True)
        of = " × ".join(f"{many} {name}" for many, name in largest[:4]) + (" × …" if len(largest) > 4 else "")
        raise BadInputError(
            f"{shown} simulations ({of}), at most {MOST_SIMULATIONS} are made",
            where=document.place(()) if not spans else document.place(("vary",)),
            fix="vary fewer values, or draw fewer vehicles; draws alone cover many dimensions",
        )


#: Where names of varied values begin, slowest first: what changes seldom is kept from one to the next.
GROUPS = ("plan", "model", "effect", "controller")


@dataclass(frozen=True)
class Axis:
    """What is varied: `group` is one of `GROUPS`, `name` what comes behind the point."""

    group: str
    name: str
    unit: str
    values: tuple[float, ...]

    @property
    def column(self) -> str:
        """What the table of results calls it."""
        return f"{self.group}.{self.name}"


@dataclass(frozen=True)
class Case:
    """One simulation: the number of its controller and of its car (0: the model itself), varied values."""

    number: int
    controller: int
    draw: int
    values: Mapping[str, Mapping[str, float]]


class Cases:
    """Every combination of the axes' values, controllers and cars, counted from 0.

    Args:
        axes: what is varied.
        controllers: how many stand in the place of the plan's own, at least 1.
        draws: cars around each model, 1 to this; 0: the model itself.
    """

    def __init__(self, axes: Sequence[Axis], controllers: int, draws: int) -> None:
        ordered = sorted(axes, key=lambda axis: GROUPS.index(axis.group))
        self._before = [axis for axis in ordered if axis.group != "controller"]
        self._behind = [axis for axis in ordered if axis.group == "controller"]
        self._controllers, self._draws = controllers, draws
        self._sizes = [
            *(len(axis.values) for axis in self._before),
            max(1, draws),
            controllers,
            *(len(axis.values) for axis in self._behind),
        ]
        self.axes = (*self._before, *self._behind)

    def __len__(self) -> int:
        return math.prod(self._sizes)

    def __getitem__(self, number: int) -> Case:
        if not 0 <= number < len(self):
            raise IndexError(number)
        digits, rest = [], number
        for size in reversed(self._sizes):
            rest, digit = divmod(rest, size)
            digits.append(digit)
        digits.reverse()
        first = len(self._before)
        draw, controller = digits[first : first + 2]
        chosen = zip(self.axes, (*digits[:first], *digits[first + 2 :]), strict=True)
        values: dict[str, dict[str, float]] = {group: {} for group in GROUPS}
        for axis, digit in chosen:
            values[axis.group][axis.name] = axis.values[digit]
        return Case(number, controller, draw + 1 if self._draws else 0, values)
