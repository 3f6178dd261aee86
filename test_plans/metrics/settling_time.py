"""Settling time: when the response stays within a band around where it ends."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array, PlannedSegment
from test_plans.metrics import _reference
from test_plans.metrics._low_pass import ORDER, low_passed
from test_plans.metrics._metric import ChannelName, DidNotSettleError, NoValueError
from test_plans.metrics._window import WindowMetric, cut, evenly


class SettlingTime(WindowMetric):
    """Time from the step until the channel, low-pass filtered, stays within the band for good.

    The band lies around the filtered channel's mean over the last `mean_s` of the window. A channel that
    leaves the band during that time has not settled, and has no settling time. The filter runs forward and
    backward over the whole segment, so that it delays nothing.
    """

    name: ClassVar[str] = "settling_time"
    never_negative: ClassVar[bool] = True
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
        half_width = self.band_percent / 100 * _reference.step_size(segment, self.step_size)
        start, end = self.bounds_s(segment)
        if end - start <= self.mean_s:
            raise NoValueError(
                f"the window is {end - start:.3g} s long, the mean alone takes {self.mean_s:g} s"
            )
        time, values = cut(recording, segment, self.channel, min(segment.start_s, start), end)
        spacing, even = evenly(time, values)
        grid = time[0] + spacing * np.arange(len(even))
        window = grid >= start - 0.5 * spacing
        grid, smooth = grid[window], self._filtered(even, spacing)[window]
        last = smooth[grid > end - self.mean_s]
        if not last.size:
            raise NoValueError(
                f"the mean's last {self.mean_s:g} s hold no sample, these lie {spacing:.3g} s apart"
            )
        final = np.mean(last)
        outside = np.flatnonzero(np.abs(smooth - final) > half_width)
        if not outside.size:
            return self.from_s
        settled = int(outside[-1]) + 1
        if settled == len(grid) or grid[settled] > end - self.mean_s:
            raise DidNotSettleError(
                f"never settled: last outside ±{half_width:.4g} {super().unit} around the mean of the last "
                f"{self.mean_s:g} s at {grid[outside[-1]] - segment.step_s:.4g} s after the step; "
                f"the window ends at {end - segment.step_s:.4g} s"
            )
        return float(grid[settled] - segment.step_s)

    def objection(self, segment: PlannedSegment) -> str:
        """No step, one of another torque than the channel's, or no room for the mean."""
        if self.step_size is None:
            objection = _reference.no_step(segment, "step_size") or _reference.not_comparable(
                segment, self.channel, "step_size"
            )
            if objection:
                return objection
        length = (segment.end_s - segment.step_s if self.to_s is None else self.to_s) - self.from_s
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


class SettlingShaftTorque(SettlingTime):
    """Settling time of T_s."""

    name: ClassVar[str] = "settling_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"
