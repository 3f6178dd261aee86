"""Band energy: mean square of a channel within a band of frequencies."""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from hil.core.channels import CHANNELS
from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.metrics._low_pass import energy_within, periodogram
from test_plans.metrics._metric import ChannelName, NoValueError
from test_plans.metrics._samples import cut
from test_plans.metrics._window import WindowMetric


class BandEnergy(WindowMetric):
    """Integral of the one-sided power spectral density over a band: a sine of amplitude A gives A²/2."""

    name: ClassVar[str] = "band_energy"
    never_negative: ClassVar[bool] = True
    from_hz: float = Field(ge=0, description="lower edge of the band, Hz")
    to_hz: float = Field(gt=0, description="upper edge of the band, Hz")

    @model_validator(mode="after")
    def _band_is_upward(self) -> Self:
        if self.to_hz <= self.from_hz:
            raise ValueError(f"to_hz = {self.to_hz:g} is not above from_hz = {self.from_hz:g}")
        return self

    @property
    def unit(self) -> str:
        """The channel's unit, squared."""
        unit = CHANNELS[self.channel].unit
        return f"({unit})²"

    @property
    def definition(self) -> str:
        """How the spectrum is made and integrated."""
        return (
            f"{self.subject} {self.window} (the sample at the end left out): linear trend removed, Hann "
            f"window, one-sided power spectral density (periodogram), integrated from {self.from_hz:g} to "
            f"{self.to_hz:g} Hz; a spectral line counts with the share of its width that lies in the band. "
            "A sine of amplitude A within the band gives A²/2."
        )

    def compute(self, recording: Recording, segment: Segment) -> float:
        """Sum of density times line spacing over the shares of lines in the band (Parseval)."""
        start_s, end_s = self.bounds_s(recording, segment)
        time, values = cut(recording, segment, self.channel, start_s, end_s, with_end=False)
        count = round((end_s - start_s) / recording.sample_time_s)
        spacing = (end_s - start_s) / count
        if 2 * self.to_hz * spacing > 1 + 1e-9:
            raise NoValueError(f"{1 / spacing:.4g} samples a second do not reach {self.to_hz:g} Hz")
        line_hz = 1 / (end_s - start_s)
        if self.to_hz - self.from_hz < 2 * line_hz:
            raise NoValueError(f"the band is narrower than two spectral lines of {line_hz:.3g} Hz")
        even = np.interp(start_s + spacing * np.arange(count), time, values)
        frequency, density = periodogram(even, spacing)
        return energy_within(frequency, density, self.from_hz, self.to_hz)


class BandEnergyMotorSpeed(BandEnergy):
    """Content of ω_m from 8 to 20 Hz, 4 to 20 s after the step: the vibration that passengers feel."""

    name: ClassVar[str] = "band_energy_motor_speed"
    channel: ChannelName = "motor_speed_rad_s"
    from_s: float = Field(default=4.0, ge=0, description="start of the window, s after the step")
    to_s: float | None = Field(default=20.0, gt=0, description="end of the window, s after the step")
    from_hz: float = Field(default=8.0, ge=0, description="lower edge of the band, Hz")
    to_hz: float = Field(default=20.0, gt=0, description="upper edge of the band, Hz")
