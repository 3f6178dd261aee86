"""What every kind of step has in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, ClassVar

from pydantic import Field

from hil.core.channels import TICK_S
from test_plans.building import Strict
from test_plans.conductor import Conductor, PlannedSegment
from test_plans.pace import Outlook, Pace

SAMPLE_TIME_S = TICK_S
LONGEST_S = 3600.0

Seconds = Annotated[float, Field(ge=0, le=LONGEST_S)]
"""A duration that may be zero."""
Duration = Annotated[float, Field(ge=0.1, le=LONGEST_S)]
"""A duration of something that must be seen, at least a tenth of a second."""
Torque = Annotated[float, Field(ge=-10_000, le=10_000)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,63}$")]
"""A name that can be part of a criterion's id and of a file name."""


class Step(Strict, ABC):
    """One entry of a plan's `steps`; its fields are the keys in YAML.

    A subclass sets `kind`, the name in YAML. A key that would collide with a property of the class
    (`duration_s`) is given as a field's alias.
    """

    kind: ClassVar[str]
    #: Keys whose value is a list of steps, which the loader makes first.
    nested: ClassVar[tuple[str, ...]] = ()

    @property
    def needs_controller(self) -> bool:
        """Whether a `set_controller` has to come before it: it asks for driving torque itself."""
        return False

    @property
    def sets_controller(self) -> bool:
        """Whether there may be a controller after it: of another package's step only a rehearsal knows."""
        return not type(self).__module__.startswith("test_plans.")

    @abstractmethod
    def execute(self, conductor: Conductor) -> None:
        """Do it on the bench; returns when done."""

    @abstractmethod
    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        """Estimated duration and the vehicle speed afterwards, when started at `speed_m_s`."""

    def segments(self) -> tuple[PlannedSegment, ...]:
        """The segments that the step will produce, in order."""
        return ()

    def numbered(self, number: int) -> Step:  # noqa: ARG002 - most have no segment
        """The same step as the `number`-th of several: its segments' ids end in _`number`."""
        return self

    @property
    def count(self) -> int:
        """How many steps are executed."""
        return 1

    @property
    def duration_s(self) -> float:
        """Estimated duration in seconds, started at standstill on a bench of default pace."""
        return self.outlook(0.0, Pace()).duration_s
