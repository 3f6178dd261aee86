"""`repeat`: the same steps several times."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Self

from pydantic import Field, WithJsonSchema, model_validator

from test_plans.conductor import Conductor, PlannedSegment
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Step

LARGEST_COUNT = 10_000


class Repeat(Step):
    """Repeat steps `times` times; in pass n the ids of their segments end in _n."""

    kind: ClassVar[str] = "repeat"
    nested: ClassVar[tuple[str, ...]] = ("steps",)
    times: int = Field(ge=1, le=LARGEST_COUNT, description="number of repetitions")
    steps: Annotated[tuple[Step, ...], WithJsonSchema({"type": "array", "minItems": 1})] = Field(
        min_length=1, description="list of the steps to repeat"
    )

    @model_validator(mode="after")
    def _finite(self) -> Self:
        if self.count > LARGEST_COUNT:
            raise ValueError(f"{self.count} steps in total, at most {LARGEST_COUNT} are allowed")
        return self

    @property
    def count(self) -> int:
        """Steps of all passes, the inner repeats' too."""
        return self.times * sum(step.count for step in self.steps)

    def segments(self) -> tuple[PlannedSegment, ...]:
        """The segments of all passes."""
        return tuple(segment for step in self._passes() for segment in step.segments())

    def execute(self, conductor: Conductor) -> None:
        """Pass after pass."""
        for step in self._passes():
            step.execute(conductor)

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        """Sum over the passes, each started at the speed that the one before left."""
        total = 0.0
        for _ in range(self.times):
            for step in self.steps:
                duration, speed_m_s = step.outlook(speed_m_s, pace)
                total += duration
        return Outlook(total, speed_m_s)

    def numbered(self, number: int) -> Self:
        """A repeat within a repeat: ids end in _outer_inner."""
        return self.model_copy(update={"steps": tuple(step.numbered(number) for step in self.steps)})

    def _passes(self) -> Iterator[Step]:
        for number in range(1, self.times + 1):
            for step in self.steps:
                yield step.numbered(number)
