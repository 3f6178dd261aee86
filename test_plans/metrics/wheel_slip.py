"""Wheel slip: how far the wheels run ahead of the vehicle or behind it."""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.metrics._metric import ChannelName, NoValueError
from test_plans.metrics._samples import cut
from test_plans.metrics._window import WindowMetric

_VEHICLE = "vehicle_speed_m_s"
_WHEELS = ("wheel_speed_rad_s", "wheel_speed_left_rad_s", "wheel_speed_right_rad_s")


class WheelSlip(WindowMetric):
    """Largest magnitude of the wheel's circumferential speed less the vehicle's."""

    name: ClassVar[str] = "wheel_slip"
    never_negative: ClassVar[bool] = True
    channel: ChannelName = Field(default=_WHEELS[0], description=f"{', '.join(_WHEELS)}; default the first")

    @model_validator(mode="after")
    def _of_a_wheel(self) -> Self:
        if self.channel not in _WHEELS:
            raise ValueError(f"a wheel slips: {', '.join(_WHEELS)}, not {self.channel}")
        return self

    @property
    def unit(self) -> str:
        """A speed: at standstill there is no share of it."""
        return "m/s"

    @property
    def channels(self) -> tuple[str, ...]:
        """Both speeds."""
        return (self.channel, _VEHICLE)

    @property
    def definition(self) -> str:
        """What is compared."""
        return (
            f"Largest magnitude of r times {self.subject} less the vehicle's speed, {self.window}; r is the "
            "rolling radius of the wheels."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The largest difference; NoValueError without a radius."""
        if segment.rolling_radius_m is None:
            raise NoValueError("the recording gives no radius of the wheels, which compares the two speeds")
        start_s, end_s = self.bounds_s(recording, segment)
        _, wheel = cut(recording, segment, self.channel, start_s, end_s)
        _, vehicle = cut(recording, segment, _VEHICLE, start_s, end_s)
        return float(np.max(np.abs(segment.rolling_radius_m * wheel - vehicle)))
