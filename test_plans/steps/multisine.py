"""`multisine`: many frequencies at once, with random phases."""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import Field, model_validator

from test_plans import stimuli
from test_plans.conductor import Array
from test_plans.steps._excitation import NYQUIST_HZ, Excitation
from test_plans.steps._step import LONGEST_S, SAMPLE_TIME_S, Duration, Name, Seconds, Torque


class Multisine(Excitation):
    """A periodic random-phase multisine; realisation n has the phases of `seed` + n.

    Metrics count from the first whole period, after the fade.
    """

    kind: ClassVar[str] = "multisine"
    segment: Name = Field(description="name of the recorded segment")
    seed: int = Field(ge=0, le=2**31, description="random seed of the phases, a whole number")
    from_hz: float = Field(ge=0, lt=NYQUIST_HZ, description="lowest frequency, Hz")
    to_hz: float = Field(gt=0, lt=NYQUIST_HZ, description="highest frequency, Hz, below 500")
    period_s: Duration = Field(description="duration of one period, s: lines lie 1/period_s apart")
    periods: int = Field(ge=1, le=1000, description="whole periods of one realisation")
    rms_nm: float | None = Field(
        default=None, gt=0, le=10_000, description="root mean square without bias, N m"
    )
    amplitude_nm: float | None = Field(
        default=None, gt=0, le=10_000, description="largest magnitude without bias, N m"
    )
    bias_nm: Torque = Field(default=0.0, description="bias torque of the multisine, N m")
    odd_only: bool = Field(default=False, description="true: odd lines only, to see even-order nonlinearity")
    realisations: int = Field(default=1, ge=1, le=100, description="number of phase draws, each a segment")
    fade_s: Seconds = Field(
        default=1.0, description="fade-in and fade-out time, s; in addition to the periods"
    )

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if (self.rms_nm is None) == (self.amplitude_nm is None):
            raise ValueError("give either rms_nm or amplitude_nm")
        if not self.from_hz < self.to_hz:
            raise ValueError(f"from_hz = {self.from_hz:g} is not below to_hz = {self.to_hz:g}")
        samples = self.period_s / SAMPLE_TIME_S
        if abs(samples - round(samples)) > 1e-6:
            raise ValueError(f"period_s = {self.period_s:g} is not a whole number of milliseconds")
        if not self._lines:
            raise ValueError("no line lies between from_hz and to_hz: give a longer period_s")
        if self.play_s > LONGEST_S:
            raise ValueError(f"one realisation takes {self.play_s:g} s, at most {LONGEST_S:g} are played")
        return self

    def samples(self, sample_time_s: float, play: int) -> Array:
        """Fade in, whole periods, fade out."""
        return stimuli.multisine(
            self._lines,
            self.period_s,
            self.periods,
            self.seed + play,
            sample_time_s,
            rms=self.rms_nm,
            amplitude=self.amplitude_nm,
            bias=self.bias_nm,
            fade_s=self.fade_s,
        )

    @property
    def plays(self) -> int:
        """Number of realisations."""
        return self.realisations

    @property
    def play_s(self) -> float:
        """One realisation with its fades."""
        return self.periods * self.period_s + 2 * self.fade_s

    @property
    def mean_nm(self) -> float:
        """The bias."""
        return self.bias_nm

    @property
    def step_s(self) -> float:
        """When the first whole period begins."""
        return self.fade_s

    @property
    def _lines(self) -> list[int]:
        return stimuli.multisine_lines(self.from_hz, self.to_hz, self.period_s, odd_only=self.odd_only)
