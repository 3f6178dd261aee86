"""Response time, arrival and holding: how soon, how exactly and how steadily a channel follows a step."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from pydantic import Field

from hil.core.channels import CHANNELS
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array, PlannedSegment
from test_plans.metrics import _samples
from test_plans.metrics._low_pass import hann
from test_plans.metrics._metric import ChannelName, NotReachedError, NoValueError
from test_plans.metrics._orders import orders_removed
from test_plans.metrics._samples import cut
from test_plans.metrics._transient import refuse_reversal
from test_plans.metrics._window import WindowMetric

_WHEEL, _MOTOR = "wheel_speed_rad_s", "motor_torque_nm"
_SETS_IN = 10.0  # %
_BY_ROUNDING = 0.5  # of a sample: so far a line begins too soon by the place of the samples alone
_ROUNDED_S = 2e-6  # times of a segment are rounded to 1e-6 s
_SHORT_MEAN_S = 0.25  # vibration from 8 Hz on has no part in it


class _Following(WindowMetric):
    """A metric of how a channel follows the step's own quantity."""

    follows_step: ClassVar[bool] = True

    def objection(self, segment: PlannedSegment) -> str:
        """No step, or one of another torque than the channel's."""
        return (
            _samples.no_step(segment)
            or _samples.not_comparable(segment, self.channel)
            or super().objection(segment)
        )


class AlreadyThereError(NoValueError):
    """What is timed had happened before the window began."""


class ResponseTime(_Following):
    """Time from the step until a channel first reaches a share of the step's size."""

    name: ClassVar[str] = "response_time"
    never_negative: ClassVar[bool] = True
    share_percent: float = Field(default=90.0, gt=0, lt=100, description="of the step's size, %")

    @property
    def unit(self) -> str:
        """Seconds."""
        return "s"

    @property
    def definition(self) -> str:
        """The first crossing."""
        return (
            f"Time from the step until {self.subject} first reaches {self.share_percent:g} % of the step's "
            f"size, linear between samples, {self.window}. No value where it is there as the window begins."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Seconds; NotReachedError where the channel does not get there, NoValueError where it was before."""
        size = _signed_size(segment)
        refuse_reversal(recording, segment)
        time, values = self.samples(recording, segment)
        progress = (values - segment.reference_before) / size
        share = self.share_percent / 100
        reached = np.flatnonzero(progress >= share)
        if not reached.size:
            raise NotReachedError(
                f"{self.channel} does not reach {self.share_percent:g} % of the step: at most "
                f"{100 * float(np.max(progress)):.3g} % within {time[-1] - segment.step_s:.3g} s"
            )
        first = int(reached[0])
        if first == 0:
            raise AlreadyThereError(
                f"{self.channel} is at {values[0]:.4g} {CHANNELS[self.channel].unit} as the window begins, "
                f"beyond {self.share_percent:g} % of the step already: what it carries beside (orders of the "
                "wheel, noise, an earlier response) hides this one"
            )
        part = (share - progress[first - 1]) / (progress[first] - progress[first - 1])
        return float(time[first - 1] + part * (time[first] - time[first - 1]) - segment.step_s)


class TimeToTolerance(ResponseTime):
    """The same as a check that a response arrives in time: one that is there at the step has."""

    @property
    def definition(self) -> str:
        """With what is there at the step."""
        return (
            f"Time from the step until {self.subject} first reaches {self.share_percent:g} % of the step's "
            f"size, linear between samples, {self.window}; 0 where it is there at the step."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Seconds, 0 where it is there at the step; NotReachedError where the channel does not get there."""
        try:
            return super().compute(recording, segment)
        except AlreadyThereError:
            return 0.0


class Delay(ResponseTime):
    """Time from the step until the response sets in: the line through 10 and 50 % of it, at 0 %.

    The first deviation itself would hang on noise and on orders of the wheel.
    """

    name: ClassVar[str] = "delay"
    share_percent: float = Field(default=50.0, gt=10, lt=100, description="of the step's size, %")

    @property
    def definition(self) -> str:
        """Where the line begins."""
        return (
            f"Time from the step until {self.subject} sets in: where a straight line through its first "
            f"crossings of {_SETS_IN:g} % and {self.share_percent:g} % of the step's size begins at 0 %, "
            f"{self.window}. No value where that is before the step."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Seconds; NotReachedError where the channel does not get there, NoValueError below 0."""
        later = super().compute(recording, segment)
        first = self.model_copy(update={"share_percent": _SETS_IN})
        sooner = super(Delay, first).compute(recording, segment)
        found = sooner - (later - sooner) * _SETS_IN / (self.share_percent - _SETS_IN)
        if found < -_BY_ROUNDING * recording.sample_time_s:
            raise NoValueError(
                f"the line through the first crossings of {_SETS_IN:g} % ({1000 * sooner:.3g} ms) and "
                f"{self.share_percent:g} % ({1000 * later:.3g} ms) begins {-1000 * found:.3g} ms before the "
                f"step: {self.channel} carries something beside the response (orders of the wheel, noise), "
                "or bends too much for a line"
            )
        return max(0.0, found)


class ResponseTimeShaftTorque(ResponseTime):
    """Response time of T_s."""

    name: ClassVar[str] = "response_time_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"


class Arrival(_Following):
    """Deviation of the end of a response from the request, in percent of the step's size."""

    name: ClassVar[str] = "arrival"
    mean_s: float = Field(default=2.0, gt=0, description="length of the mean at the window's end, s")

    @property
    def unit(self) -> str:
        """Percent."""
        return "%"

    @property
    def definition(self) -> str:
        """Mean at the end minus the reference."""
        return (
            f"Mean of {self.subject} over the last {self.mean_s:g} s of the window, {self.window} (whole "
            "periods of the lowest declared order of the wheel), minus the value after the step, in percent "
            "of the step's size: positive beyond it, negative short of it."
        )

    def objection(self, segment: PlannedSegment) -> str:
        """Also a window that is shorter than the mean."""
        return _no_room(self.planned_length_s(segment), self.mean_s) or super().objection(segment)

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Percent of the step, in its direction; NoValueError in a window that is shorter than the mean."""
        size = _signed_size(segment)
        refuse_reversal(recording, segment)
        return 100 * (self._mean(recording, segment, self.channel) - segment.reference_after) / size

    def remark(self, recording: Recording, segment: Segment) -> str:
        """Whether the torque is lost behind the motor, or was never made."""
        if self.channel != "shaft_torque_nm" or segment.gear_ratio is None or _MOTOR not in recording:
            return ""
        at_motor = segment.gear_ratio * self._mean(recording, segment, _MOTOR)
        at_shafts = self._mean(recording, segment, self.channel)
        asked = segment.reference_after
        if abs(at_shafts - at_motor) > abs(at_motor - asked):
            where = "between motor and shafts: friction, losses of the gear, or the sensor's scale"
        else:
            where = "before the motor: in what the controller asks for, or in what the RMCU gives"
        return (
            f"asked {asked:.4g} N m, N T_m {at_motor:.4g} N m, T_s {at_shafts:.4g} N m: most of the "
            f"difference arises {where}"
        )

    def _mean(self, recording: Recording, segment: Segment, channel: str) -> float:
        """Of the end of the window."""
        start_s, end_s = self.bounds_s(recording, segment)
        short = _no_room(end_s - start_s, self.mean_s)
        if short:
            raise NoValueError(short)
        time, values = cut(recording, segment, channel, start_s, end_s)
        first = int(np.searchsorted(time, time[-1] - self.mean_s, "right"))
        if segment.wheel_orders and _WHEEL in recording:
            _, speed = cut(recording, segment, _WHEEL, start_s, end_s)
            periods = min(segment.wheel_orders) / (2 * np.pi) * _integral(time[first:], speed[first:])
            whole = np.floor(abs(periods[-1]))
            if whole >= 1:
                first += int(np.searchsorted(np.abs(periods), abs(periods[-1]) - whole))
        return float(np.mean(values[first:]))


def _no_room(length_s: float, mean_s: float) -> str:
    """Why a window has no mean; '' where it has."""
    if length_s >= mean_s - _ROUNDED_S:
        return ""
    return f"the window is {length_s:.3g} s long, the mean alone takes {mean_s:g} s: give 'mean_s'"


def _integral(time: Array, values: Array) -> Array:
    """From the first sample to each, shape (n,)."""
    found: Array = np.zeros(len(time))
    found[1:] = np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time))
    return found


class Holding(_Following):
    """Largest deviation of a response from the request, after the time in which it should have settled."""

    name: ClassVar[str] = "holding"
    never_negative: ClassVar[bool] = True

    @property
    def unit(self) -> str:
        """Percent."""
        return "%"

    @property
    def channels(self) -> tuple[str, ...]:
        """The channel and the wheel's speed."""
        return (self.channel, _WHEEL)

    @property
    def definition(self) -> str:
        """The worst of short means."""
        return (
            f"Largest distance of the means of {self.subject} over {_SHORT_MEAN_S:g} s (Hann window) from "
            "the value after the step, in the second half of the window, without the orders of the wheel "
            "that the bench file declares, in percent of the step's size."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Percent of the step."""
        _, away = self._worst(recording, segment)
        return 100 * abs(away) / abs(segment.reference_after - segment.reference_before)

    def remark(self, recording: Recording, segment: Segment) -> str:
        """When, and where it was."""
        late_s, away = self._worst(recording, segment)
        asked = segment.reference_after
        return (
            f"{self.channel} was at {asked + away:.4g} N m {late_s:.3g} s after the step, asked {asked:.4g}"
        )

    def _worst(self, recording: Recording, segment: Segment) -> tuple[float, float]:
        """Time after the step, and distance from the reference in the channel's unit."""
        _signed_size(segment)
        start_s, end_s = self.bounds_s(recording, segment)
        middle_s = 0.5 * (start_s + end_s)
        spacing_s, values = orders_removed(recording, segment, self.channel, middle_s, end_s)
        length = round(_SHORT_MEAN_S / spacing_s)
        if len(values) < length:
            raise NoValueError(f"{end_s - middle_s:.3g} s are too short for a mean")
        kernel = hann(length)
        away = np.convolve(values - segment.reference_after, kernel / np.sum(kernel), "valid")
        worst = int(np.argmax(np.abs(away)))
        late_s = middle_s - segment.step_s + (worst + 0.5 * length) * spacing_s
        return late_s, float(away[worst])


def _signed_size(segment: Segment) -> float:
    """Of the step, in its direction; NoValueError if there is none."""
    return math.copysign(
        _samples.step_size(segment, None), segment.reference_after - segment.reference_before
    )


class ArrivalShaftTorque(Arrival):
    """Arrival of T_s."""

    name: ClassVar[str] = "arrival_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"
