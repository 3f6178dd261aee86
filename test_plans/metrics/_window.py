"""The window after a step in which a metric looks at one channel."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from hil.core.channels import CHANNELS
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array, PlannedSegment
from test_plans.metrics._metric import ChannelName, Metric
from test_plans.metrics._samples import cut, no_step
from test_plans.metrics._transient import FOLLOWS, transient_end_s, transient_in_words


class WindowMetric(Metric):
    """A metric of one channel from `from_s` to `to_s` after the step, or from the first change of torque on.

    One that follows the step in its direction, `follows_step`, cannot begin before it.
    """

    follows_step: ClassVar[bool] = False
    channel: ChannelName = Field(description="name of a channel, e.g. shaft_torque_nm")
    from_s: float = Field(default=0.0, ge=0, description="start of the window, s after the step")
    to_s: float | None = Field(
        default=None, gt=0, description="end of the window, s after the step; default: the segment's end"
    )
    since: Literal["step", "first_change"] = Field(
        default="step",
        description="first_change: the window begins where the torque first changes, not at the last step of "
        "stairs",
    )
    until: Literal["end", "transient"] = Field(
        default="end",
        description="transient: the window ends when the first transient has been over for 0.5 s",
    )

    @model_validator(mode="after")
    def _window_is_forward(self) -> Self:
        if self.until == "transient" and self.to_s is not None:
            raise ValueError("to_s and 'until: transient' both end the window: leave one out")
        if self.since == "first_change" and self.follows_step:
            raise ValueError(
                f"'{self.name}' follows one step in its direction and cannot begin before it: leave out "
                "'since: first_change', give the change a step of its own, or limit 'magnitude'"
            )
        if self.since == "first_change" and self.from_s > 0:
            raise ValueError("from_s and 'since: first_change' both begin the window: leave one out")
        if self.to_s is not None and self.to_s <= self.from_s:
            raise ValueError(f"to_s = {self.to_s:g} is not after from_s = {self.from_s:g}")
        return self

    @property
    def unit(self) -> str:
        """The channel's unit."""
        return CHANNELS[self.channel].unit

    @property
    def window(self) -> str:
        """The window in words."""
        start = self._origin if self.from_s == 0 else f"{self.from_s:g} s after the step"
        end = "the end of the segment" if self.to_s is None else f"{self.to_s:g} s after the step"
        end = transient_in_words() if self.until == "transient" else end
        return f"from {start} until {end}"

    @property
    def _origin(self) -> str:
        """Where the window begins, or `from_s` counts from."""
        return "the step" if self.since == "step" else "the first change of torque in the segment"

    @property
    def subject(self) -> str:
        """The channel in words."""
        return f"{self.channel} ({CHANNELS[self.channel].symbol})"

    def objection(self, segment: PlannedSegment) -> str:
        """The segment is planned to end before the window does."""
        length = segment.end_s - segment.step_s
        needed = self.from_s if self.to_s is None else self.to_s
        if needed > length + 1e-9:
            return f"the window reaches to {needed:g} s after the step, the segment to {length:g} s"
        if self.until == "transient":
            return no_step(segment)
        return ""

    def planned_length_s(self, segment: PlannedSegment) -> float:
        """How long the window is in a segment planned so, s; a transient may end it sooner."""
        since_change = self.since == "first_change" and segment.first_change_s is not None
        before_s = segment.step_s - (segment.first_change_s or 0.0) if since_change else 0.0
        until_s = segment.end_s - segment.step_s if self.to_s is None else self.to_s
        return before_s + until_s - self.from_s

    @property
    def channels(self) -> tuple[str, ...]:
        """The channel; where the window ends with the transient, also what shows its end."""
        own = (self.channel,)
        return own if self.until == "end" else tuple(dict.fromkeys((*own, FOLLOWS["driving_torque"])))

    def origin_s(self, segment: Segment) -> float:
        """The step, or the first change of torque, on the recording's time."""
        return segment.step_s if self.since == "step" else segment.changes_from_s

    def bounds_s(self, recording: Recording, segment: Segment) -> tuple[float, float]:
        """Begin and end of the window on the recording's time.

        Raises:
            NoValueError: the window is to end with the first transient, and there is none that ends.
        """
        start = self.origin_s(segment) + self.from_s
        if self.until == "transient":
            return start, transient_end_s(recording, segment)
        end = segment.end_s if self.to_s is None else segment.step_s + self.to_s
        return start, end

    def samples(self, recording: Recording, segment: Segment) -> tuple[Array, Array]:
        """Time stamps and values in the window, both ends included.

        Raises:
            NoValueError: the segment is too short, or samples are missing.
        """
        return cut(recording, segment, self.channel, *self.bounds_s(recording, segment))
