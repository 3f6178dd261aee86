"""What every metric has in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import AfterValidator, Field

from hil.core.channels import CHANNELS, TIME
from hil.core.errors.wording import did_you_mean
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.building import Strict
from test_plans.conductor import PlannedSegment

_NAMES = [name for name in CHANNELS if name != TIME]


def _known(channel: str) -> str:
    if channel not in _NAMES:
        raise ValueError(f"unknown channel {channel!r}; {did_you_mean(channel, _NAMES)}")
    return channel


ChannelName = Annotated[str, AfterValidator(_known), Field(json_schema_extra={"enum": [*_NAMES]})]
"""A channel of hil.core.channels other than time."""


class NoValueError(Exception):
    """The metric has no value for this segment; the message says why."""


class NotReachedError(NoValueError):
    """What is timed did not happen within the window: with a limit on it that is a failure."""


class DidNotSettleError(NoValueError):
    """The response was still moving at the end of the window: there is no settling time to tell."""


@dataclass(frozen=True)
class Limits:
    """What a criterion demands of a metric, in its unit; `below`: the segment that it is compared with."""

    upper: float | None = None
    lower: float | None = None
    below: str = ""


class Metric(Strict, ABC):
    """One number of one segment; the fields are its parameters, keys of a criterion in YAML."""

    name: ClassVar[str]
    never_negative: ClassVar[bool] = False  # then no lower limit of zero or less can be broken

    @property
    @abstractmethod
    def unit(self) -> str:
        """Unit of the value."""

    @property
    @abstractmethod
    def definition(self) -> str:
        """How the value is computed, with these parameters; printed in reports."""

    @abstractmethod
    def compute(self, recording: Recording, segment: Segment) -> float:
        """The value.

        Raises:
            NoValueError: samples are missing, or the segment is too short.
            DidNotSettleError: what is looked for had not come to rest.
            BadInputError: the recording has no such channel.
        """

    def remark(self, recording: Recording, segment: Segment) -> str:  # noqa: ARG002 - most have none
        """What a reader should know of a value that failed; '' if nothing."""
        return ""

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that the value is computed from: each must be proven to have been measured."""
        own = getattr(self, "channel", None)
        return (own,) if isinstance(own, str) else ()

    def objection_to_limits(self, segment: PlannedSegment, limits: Limits) -> str:  # noqa: ARG002
        """Why limits cannot bound the metric in a segment planned so: what can; empty if they do."""
        return ""

    def objection(self, segment: PlannedSegment) -> str:  # noqa: ARG002 - most have none
        """Why the metric cannot have a value in a segment that is planned so; empty if it can."""
        return ""
