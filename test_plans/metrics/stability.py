"""Stability: does the loop come to rest, or does it shake, bang between its limits, or grow?"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from hil.core.errors import HilError
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import PlannedSegment
from test_plans.metrics import _lines
from test_plans.metrics._metric import ChannelName, Metric, NoValueError
from test_plans.metrics._orders import orders_removed
from test_plans.metrics._samples import cut, no_step
from test_plans.metrics._window import WindowMetric

_WHEEL = "wheel_speed_rad_s"
_REQUEST = "motor_torque_ref_nm"
#: A request this close to its limit lies at it; one against what was asked for counts from this share of it.
_AT_LIMIT, _AGAINST = 0.999, 0.05
_ASKED, _LEAST_NM = 0.1, 20.0  # of the step, and at all: noise and orders turn a smaller torque around
_LEAST_S = 0.4  # of the second half: less shows no line
_LEAST_TURNS_HZ, _SAME, _HIGHEST_ORDER = 0.5, 0.1, 12  # of a line that may be an order
_LATEST_S = 0.1
_NOISE_NM = 0.5  # of a request around zero
_LOOKED_AT_S = 3.0  # at the end of a segment that was cut short
_MOST_OF_IT = 0.2  # of the second half: a stable loop has left its limit by then


class StabilityTorqueRequest(Metric):
    """Share of a window's second half in which T_m* is at its limit, or opposite to the request."""

    name: ClassVar[str] = "stability_torque_request"
    never_negative: ClassVar[bool] = True
    limit_nm: float | None = Field(
        default=None,
        gt=0,
        description="torque limit of the controller, N m; default: that of the segment's controller",
    )

    @property
    def unit(self) -> str:
        """A share."""
        return "1"

    @property
    def channels(self) -> tuple[str, ...]:
        """The request."""
        return (_REQUEST,)

    @property
    def definition(self) -> str:
        """When a request counts."""
        return (
            f"Share of the second half of the time after the step in which {_REQUEST} (T_m*) lies at the "
            "controller's torque limit, or has the other sign than the torque that was asked for."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """From 0 to 1."""
        middle_s = 0.5 * (segment.step_s + segment.end_s)
        _, request = cut(recording, segment, _REQUEST, middle_s, segment.end_s)
        limit_nm = self.limit_nm or segment.torque_limit_nm
        counted = np.zeros(len(request), bool)
        if limit_nm is not None:
            counted |= np.abs(request) >= _AT_LIMIT * limit_nm
        size = abs(segment.reference_after - segment.reference_before)
        if abs(segment.reference_after) >= max(_ASKED * size, _LEAST_NM):
            asked = np.sign(segment.reference_after)
            against_nm = max(_AGAINST * float(np.max(np.abs(request))), _NOISE_NM)
            counted |= asked * request < -against_nm
        return float(np.mean(counted))


class StabilityOscillation(WindowMetric):
    """Amplitude of the strongest sustained line that is not a declared order of the wheel."""

    name: ClassVar[str] = "stability_oscillation"
    never_negative: ClassVar[bool] = True
    follows_step: ClassVar[bool] = True
    channel: ChannelName = "shaft_torque_nm"

    @property
    def channels(self) -> tuple[str, ...]:
        """The channel and the wheel's speed."""
        return (self.channel, _WHEEL)

    @property
    def definition(self) -> str:
        """How lines are found, and which count."""
        return (
            f"Amplitude of the strongest line of {self.subject} in blocks of half a second within the second "
            "half of the window (linear trend removed, Hann window, two periods at least, five times the "
            "median of the spectrum), without the orders of the wheel that the bench file declares, unless "
            "the motor makes them. A line that only decays counts as it is in the middle block."
        )

    def objection(self, segment: PlannedSegment) -> str:
        """No step: what is excited is no cycle of the loop."""
        return no_step(segment) or super().objection(segment)

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The amplitude in the channel's unit."""
        return self.line(recording, segment).amplitude

    def line(self, recording: Recording, segment: Segment) -> _lines.Line:
        """The line itself, with its frequency.

        Raises:
            NoValueError: the window is too short, or samples are missing.
        """
        start_s, end_s = self._second_half(recording, segment)
        spacing_s, left = orders_removed(recording, segment, self.channel, start_s, end_s)
        return _lines.lasting_line(left, spacing_s)

    def remark(self, recording: Recording, segment: Segment) -> str:
        """The line's frequency, and which order of the wheel it would be."""
        line = self.line(recording, segment)
        text = f"the line lies at {line.frequency_hz:.3g} Hz"
        _, speed = cut(recording, segment, _WHEEL, *self._second_half(recording, segment))
        order = line.frequency_hz / max(float(np.mean(speed)) / (2 * np.pi), _LEAST_TURNS_HZ)
        whole = round(order)
        declared = any(abs(order - one) < _SAME * one for one in segment.wheel_orders)
        if declared or not 1 <= whole <= _HIGHEST_ORDER or abs(order - whole) > _SAME:
            return text
        return (
            f"{text}, which is order {whole} of the wheel: if a joint or tyre excites it, and not the "
            "control loop, declare it in the bench file as one of vehicle.wheel_orders"
        )

    def _second_half(self, recording: Recording, segment: Segment) -> tuple[float, float]:
        """Begin and end; NoValueError if it is too short."""
        start_s, end_s = self.bounds_s(recording, segment)
        middle_s = 0.5 * (start_s + end_s)
        if end_s - middle_s < _LEAST_S:
            raise NoValueError(f"{end_s - middle_s:.3g} s are too short for a line")
        return middle_s, end_s


def instability(recording: Recording, segment: Segment) -> str:
    """What shows that the loop was not stable when a segment was cut short, in words; '' if nothing does.

    Either the request lay at its limit, or against what was asked, for a fifth of the second half; or T_s
    swung by more than a tenth of the step over three periods and more, without decay, up to the end, without
    the orders of the wheel that the bench file declares.
    """
    if segment.quantity == "motor_torque":
        return ""  # no loop: what rings is the axle
    # The last samples of slower or later devices may be missing.
    segment = segment.model_copy(update={"end_s": segment.end_s - _LATEST_S})
    try:
        share = StabilityTorqueRequest().compute(recording, segment)
        start_s = max(segment.step_s, segment.end_s - _LOOKED_AT_S)
        spacing_s, even = orders_removed(recording, segment, "shaft_torque_nm", start_s, segment.end_s)
    except (NoValueError, HilError):
        return ""
    if segment.end_s - segment.step_s >= _LEAST_S and share >= _MOST_OF_IT:
        return f"T_m* is at its limit, or opposite to the request, for {100 * share:.0f} % of the time"
    found = _lines.swings(even, spacing_s)
    size = abs(segment.reference_after - segment.reference_before)
    if found is None or found.last < _ASKED * size or found.last < _lines.DECAYS * found.first:
        return ""
    return f"T_s oscillates at {found.frequency_hz:.3g} Hz with {found.last:.3g} N m and does not decay"
