"""Jerk: how fast the vehicle's acceleration changes, which a driver feels as a push or a blow."""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.conductor import Array
from test_plans.metrics._low_pass import ORDER, low_passed
from test_plans.metrics._metric import ChannelName, NoValueError
from test_plans.metrics._samples import cut, evenly
from test_plans.metrics._window import WindowMetric

_SPEED, _TORQUE = "vehicle_speed_m_s", "shaft_torque_nm"
_COARSE = 0.1  # of the value: what steps of V̂ may make of it
_AROUND = 10  # periods of the corner frequency, after which a filter has forgotten
_PEAK_OVER_RMS = 4.0  # of white noise in some thousand samples


class Jerk(WindowMetric):
    """Largest magnitude of the second derivative of the vehicle's speed, low-pass filtered.

    Low-pass at 25 Hz: people feel longitudinal vibration up to some 20 Hz, and drivability is judged there.
    From T_s the wheel force over the mass, T_s / (r m), stands for the acceleration: the wheels' own inertia
    is neglected, one or two percent of the vehicle's.
    """

    name: ClassVar[str] = "jerk"
    never_negative: ClassVar[bool] = True
    channel: ChannelName = Field(
        default=_SPEED, description=f"{_SPEED} (default), or {_TORQUE} with 'mass_kg'"
    )
    low_pass_hz: float = Field(
        default=25.0, gt=0, lt=500, description="corner frequency of the low-pass filter, Hz"
    )
    mass_kg: float | None = Field(
        default=None, gt=0, description="vehicle's mass, kg: the wheel force over it is the acceleration"
    )

    @model_validator(mode="after")
    def _has_an_acceleration(self) -> Self:
        if self.channel not in (_SPEED, _TORQUE):
            raise ValueError(f"the vehicle's jerk comes from {_SPEED} or {_TORQUE}, not {self.channel}")
        if self.channel == _TORQUE and self.mass_kg is None:
            raise ValueError(f"channel {_TORQUE} needs 'mass_kg', the vehicle's mass")
        if self.channel != _TORQUE and self.mass_kg is not None:
            raise ValueError(f"'mass_kg' belongs to channel {_TORQUE}, and to no other")
        return self

    @property
    def unit(self) -> str:
        """That of a jerk."""
        return "m/s³"

    @property
    def definition(self) -> str:
        """What is differentiated."""
        low_pass = (
            f"low-pass filtered at {self.low_pass_hz:g} Hz (Butterworth, order {ORDER}, forward and backward)"
        )
        if self.mass_kg is None:
            source = "second derivative of the vehicle's speed"
            rule = (
                f"The speed is differenced from sample to sample, {low_pass}, and differenced again: the "
                "value at a sample is the second difference over three, (v[k+1] - 2 v[k] + v[k-1]) / T², of "
                "the filtered speed."
            )
        else:
            source = f"derivative of the wheel force over {self.mass_kg:g} kg, T_s / (r m)"
            rule = (
                f"The torque is {low_pass}; the value at a sample is the difference of its two neighbours "
                "over 2 T."
            )
        return (
            f"Largest magnitude of the {source} ({self.subject}), {self.window}. {rule} The filter's last "
            "period before the segment's end is left out."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Largest magnitude; NoValueError where V̂ moves in too large steps to be differentiated twice."""
        return abs(self.largest(recording, segment)[1])

    def largest(self, recording: Recording, segment: Segment) -> tuple[float, float]:
        """Time after the step (s) and value (m/s³, signed) of the largest jerk.

        Raises:
            NoValueError: as `compute`.
        """
        start_s, end_s = self.bounds_s(recording, segment)
        later_s = min(segment.end_s, end_s + _AROUND / self.low_pass_hz)  # the filter needs what follows
        time, values = cut(
            recording, segment, self.channel, min(segment.start_s, start_s), max(end_s, later_s)
        )
        spacing_s, even = evenly(time, values)
        if 2 * self.low_pass_hz * spacing_s >= 1:
            raise NoValueError(f"{1 / spacing_s:.4g} samples a second do not reach {self.low_pass_hz:g} Hz")
        jerk = self._differentiated(even, spacing_s) * self._scale(segment)
        grid = time[0] + spacing_s * np.arange(len(even))
        # Beyond the segment the next request acts: near its end the filter continues the samples by itself.
        known_until_s = min(end_s, segment.end_s - 1 / self.low_pass_hz)
        inside = (grid >= start_s - 0.5 * spacing_s) & (grid <= known_until_s + 0.5 * spacing_s)
        place = int(np.argmax(np.where(inside, np.abs(jerk), -1.0)))
        if self.mass_kg is None:
            self._refuse_coarse(values, spacing_s, abs(float(jerk[place])))
        return float(grid[place] - segment.step_s), float(jerk[place])

    def _differentiated(self, values: Array, spacing_s: float) -> Array:
        """Of the speed twice, of the torque once; of the shape of `values`, 0 at both ends."""
        found: Array = np.zeros(len(values))
        if self.mass_kg is None:  # filtered as an acceleration: the filter continues it at both ends
            acceleration = np.diff(values) / spacing_s
            found[1:-1] = np.diff(low_passed(acceleration, self.low_pass_hz, spacing_s)) / spacing_s
        else:
            smooth = low_passed(values, self.low_pass_hz, spacing_s)
            found[1:-1] = (smooth[2:] - smooth[:-2]) / (2 * spacing_s)
        return found

    def _scale(self, segment: Segment) -> float:
        """From the channel's derivative to a jerk."""
        if self.mass_kg is None:
            return 1.0
        if segment.rolling_radius_m is None:
            raise NoValueError("the recording does not give the wheel's radius, which makes torque a force")
        return 1.0 / (self.mass_kg * segment.rolling_radius_m)

    def _refuse_coarse(self, speed: Array, spacing_s: float, found: float) -> None:
        """Refuse a speed whose resolution alone makes a share of the value."""
        steps = np.diff(np.unique(speed))
        if not steps.size:
            return
        step = float(np.min(steps))
        impulse: Array = np.zeros(max(64, round(4 / (self.low_pass_hz * spacing_s))))
        impulse[len(impulse) // 2] = step / np.sqrt(12)
        made = _PEAK_OVER_RMS * float(np.linalg.norm(self._differentiated(impulse, spacing_s)))
        if made > _COARSE * found:
            raise NoValueError(
                f"{self.channel} moves in steps of {step:.2g} m/s, which alone make {made:.2g} m/s³ of "
                f"{found:.2g}: take channel {_TORQUE} with 'mass_kg'"
            )
