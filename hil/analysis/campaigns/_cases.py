"""Which simulation has which values: one number for each, the same whoever carries it out and when."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

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
