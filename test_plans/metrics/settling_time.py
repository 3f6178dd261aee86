"""Settling time: when the response stays within a band around where it ends."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from hil.core.channels import CHANNELS
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array, PlannedSegment
from test_plans.metrics import _samples
from test_plans.metrics._low_pass import ORDER, low_passed
from test_plans.metrics._metric import ChannelName, DidNotSettleError, NoValueError
from test_plans.metrics._orders import orders_removed
from test_plans.metrics._samples import cut, evenly
from test_plans.metrics._transient import refuse_reversal
from test_plans.metrics._window import WindowMetric

Cut = tuple[float, float, Array]


class SettlingTime(WindowMetric):
    """Time from the step until the channel, low-pass filtered, stays within the band for good.

    The band lies around the filtered channel's mean over the last `mean_s` of the window. A channel that
    leaves the band during that time has not settled, and has no settling time. The filter runs forward and
    backward over the whole segment, so that it delays nothing.
    """

    name: ClassVar[str] = "settling_time"
    never_negative: ClassVar[bool] = True
    follows_step: ClassVar[bool] = True
    band_percent: float = Field(
        default=5.0, gt=0, le=100, description="half width of the band, % of the step's size"
    )
    mean_s: float = Field(default=2.0, gt=0, description="length of the mean at the window's end, s")
    low_pass_hz: float = Field(default=50.0, gt=0, description="corner frequency of the low-pass filter, Hz")
    step_size: float | None = Field(
        default=None, gt=0, description="value of 100 %, in the channel's unit; default: the step's magnitude"
    )

    @property
    def unit(self) -> str:
        """Seconds."""
        return "s"

    @property
    def definition(self) -> str:
        """When the response stays within the band."""
        size = "the step's size" if self.step_size is None else f"{self.step_size:g}"
        return (
            f"Time from the step after which {self.subject} stays within ±{self.band_percent:g} % of {size} "
            f"around its mean over the last {self.mean_s:g} s, {self.window}. The channel is low-pass "
            f"filtered at {self.low_pass_hz:g} Hz (Butterworth, order {ORDER}, forward and "
            f"backward). Outside during the last {self.mean_s:g} s: did not settle."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Seconds after the step; DidNotSettleError if it is outside during the last `mean_s`."""
        half_width = self.band_percent / 100 * _samples.step_size(segment, self.step_size)
        refuse_reversal(recording, segment)
        start, end = self.bounds_s(recording, segment)
        if end - start <= self.mean_s:
            raise NoValueError(
                f"the window is {end - start:.3g} s long, the mean alone takes {self.mean_s:g} s"
            )
        first_s, spacing, even = self._even(recording, segment, min(segment.start_s, start), end)
        grid = first_s + spacing * np.arange(len(even))
        window = grid >= start - 0.5 * spacing
        grid, smooth = grid[window], self._filtered(even, spacing)[window]
        last = smooth[grid > end - self.mean_s]
        if not last.size:
            raise NoValueError(
                f"the mean's last {self.mean_s:g} s hold no sample, these lie {spacing:.3g} s apart"
            )
        final, around = self._final(segment, last)
        outside = np.flatnonzero(np.abs(smooth - final) > half_width)
        if not outside.size:
            return self.from_s
        settled = int(outside[-1]) + 1
        if settled == len(grid) or grid[settled] > end - self.mean_s:
            raise DidNotSettleError(
                f"never settled: last outside ±{half_width:.4g} {CHANNELS[self.channel].unit} around "
                f"{around} at {grid[outside[-1]] - segment.step_s:.4g} s after the step; "
                f"the window ends at {end - segment.step_s:.4g} s"
            )
        return float(grid[settled] - segment.step_s)

    def _even(self, recording: Recording, segment: Segment, start_s: float, end_s: float) -> Cut:
        """Time of the first sample, sample time, and the channel on an even grid."""
        time, values = cut(recording, segment, self.channel, start_s, end_s)
        return float(time[0]), *evenly(time, values)

    def _final(self, segment: Segment, last: Array) -> tuple[float, str]:
        """Where the response is to rest, and that in words."""
        del segment
        return float(np.mean(last)), f"the mean of the last {self.mean_s:g} s"

    def objection(self, segment: PlannedSegment) -> str:
        """No step, one of another torque than the channel's, or no room for the mean."""
        if self.step_size is None:
            objection = _samples.no_step(segment, "step_size") or _samples.not_comparable(
                segment, self.channel, "step_size"
            )
            if objection:
                return objection
        length = self.planned_length_s(segment)
        if length <= self.mean_s:
            return f"the window is {length:g} s long, the mean alone takes {self.mean_s:g} s"
        return super().objection(segment)

    def _filtered(self, values: Array, spacing_s: float) -> Array:
        if 2 * self.low_pass_hz * spacing_s >= 1:
            raise NoValueError(
                f"a low-pass at {self.low_pass_hz:g} Hz needs more than {2 * self.low_pass_hz:g} samples a "
                f"second, the recording has {1 / spacing_s:.4g}"
            )
        return low_passed(values, self.low_pass_hz, spacing_s)


class SettlingToReference(SettlingTime):
    """Settling around what was asked for: a response that rests beside it has not settled.

    Declared orders of the wheel are taken out first: they are ripple, which `ripple` tells apart.
    """

    name: ClassVar[str] = "settling_to_reference"
    reference: float | None = Field(
        default=None,
        description="value to settle at, in the channel's unit; default: the value after the step",
    )

    @property
    def definition(self) -> str:
        """When the response stays near the reference."""
        size = "the step's size" if self.step_size is None else f"{self.step_size:g}"
        around = "the value after the step" if self.reference is None else f"{self.reference:g}"
        return (
            f"Time from the step after which {self.subject}, without the orders of the wheel that the bench "
            f"file declares, stays within ±{self.band_percent:g} % of {size} around {around}, {self.window}. "
            f"Low-pass filtered at {self.low_pass_hz:g} Hz (Butterworth, order {ORDER}, forward and "
            f"backward). Outside during the last {self.mean_s:g} s: did not settle."
        )

    @property
    def channels(self) -> tuple[str, ...]:
        """The channel and the wheel's speed."""
        return (self.channel, "wheel_speed_rad_s")

    def objection(self, segment: PlannedSegment) -> str:
        """Also when the reference is not the channel's."""
        objection = (
            "" if self.reference is not None else _samples.not_comparable(segment, self.channel, "reference")
        )
        return objection or super().objection(segment)

    def _even(self, recording: Recording, segment: Segment, start_s: float, end_s: float) -> Cut:
        spacing, values = orders_removed(recording, segment, self.channel, start_s, end_s)
        return start_s, spacing, values

    def _final(self, segment: Segment, last: Array) -> tuple[float, str]:
        del last
        return _samples.reference(segment, self.reference), "the reference"


class Ripple(WindowMetric):
    """What still moves at the end of a response, orders of the wheel included."""

    name: ClassVar[str] = "ripple"
    never_negative: ClassVar[bool] = True
    mean_s: float = Field(default=2.0, gt=0, description="length of the stretch at the window's end, s")

    @property
    def definition(self) -> str:
        """Half of peak to peak."""
        return (
            f"Half the distance between the largest and the smallest value of {self.subject} in the last "
            f"{self.mean_s:g} s, {self.window}."
        )

    def objection(self, segment: PlannedSegment) -> str:
        """A window that is shorter than the stretch."""
        length = self.planned_length_s(segment)
        if length < self.mean_s - 1e-9:
            return f"the window is {length:g} s long, the stretch takes {self.mean_s:g} s: give 'mean_s'"
        return super().objection(segment)

    def compute(self, recording: Recording, segment: Segment) -> float:
        """In the channel's unit."""
        start, end = self.bounds_s(recording, segment)
        if end - start < self.mean_s - 1e-9:
            raise NoValueError(f"the window is {end - start:.3g} s long, the stretch takes {self.mean_s:g} s")
        _, values = cut(recording, segment, self.channel, end - self.mean_s, end)
        return float(0.5 * np.ptp(values))


class SettlingShaftTorque(SettlingTime):
    """Settling time of T_s."""

    name: ClassVar[str] = "settling_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"
