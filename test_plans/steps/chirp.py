"""`chirp`: a sine that runs through the frequencies."""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import Field, model_validator

from test_plans import stimuli
from test_plans.conductor import Array
from test_plans.steps._excitation import NYQUIST_HZ, Excitation
from test_plans.steps._step import Duration, Name, Seconds, Torque


class Chirp(Excitation):
    """A swept sine around a bias, faded in and out."""

    kind: ClassVar[str] = "chirp"
    segment: Name = Field(description="name of the recorded segment")
    from_hz: float = Field(ge=0, lt=NYQUIST_HZ, description="start frequency, Hz")
    to_hz: float = Field(gt=0, lt=NYQUIST_HZ, description="end frequency, Hz, below 500")
    sweep_s: Duration = Field(alias="duration_s", description="duration of one sweep, s, at least 0.1")
    amplitude_nm: float = Field(gt=0, le=10_000, description="amplitude of the sine, N m")
    bias_nm: Torque = Field(default=0.0, description="bias torque of the sine, N m")
    sweep: stimuli.Sweep = Field(default="logarithmic", description="linear or logarithmic")
    fade_s: Seconds = Field(default=1.0, description="fade-in and fade-out time, s; part of duration_s")
    repeats: int = Field(default=1, ge=1, le=100, description="number of sweeps, each a segment")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if not self.from_hz < self.to_hz:
            raise ValueError(f"from_hz = {self.from_hz:g} is not below to_hz = {self.to_hz:g}")
        if self.sweep == "logarithmic" and self.from_hz < 1e-4:
            raise ValueError("a logarithmic sweep cannot begin at 0 Hz: give from_hz, or sweep: linear")
        if 2 * self.fade_s > self.sweep_s:
            raise ValueError(f"fade_s twice does not fit into duration_s = {self.sweep_s:g}")
        return self

    def samples(self, sample_time_s: float, play: int) -> Array:  # noqa: ARG002 - all plays are the same
        """One sweep."""
        return stimuli.chirp(
            self.from_hz,
            self.to_hz,
            self.sweep_s,
            self.amplitude_nm,
            sample_time_s,
            bias=self.bias_nm,
            sweep=self.sweep,
            fade_s=self.fade_s,
        )

    @property
    def plays(self) -> int:
        """Number of sweeps."""
        return self.repeats

    @property
    def play_s(self) -> float:
        """One sweep."""
        return self.sweep_s

    @property
    def mean_nm(self) -> float:
        """The bias."""
        return self.bias_nm
