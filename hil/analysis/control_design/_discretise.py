"""The RMCU's arithmetic: each block by Tustin's rule at the controller's sample time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import signal

from hil.core.errors import BadInputError
from hil.core.model import TransferFunction

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class DiscreteFilter:
    """b/a in ascending powers of z⁻¹, a[0] = 1."""

    b: tuple[float, ...]
    a: tuple[float, ...]
    sample_time_s: float

    def response(self, frequency_hz: Array) -> ComplexArray:
        """Complex response below half the sampling rate."""
        z = np.exp(-2j * np.pi * np.asarray(frequency_hz) * self.sample_time_s)
        return np.asarray(np.polyval(self.b[::-1], z) / np.polyval(self.a[::-1], z))

    @property
    def stable(self) -> bool:
        """Whether every pole lies inside the unit circle."""
        return bool(np.all(np.abs(np.roots(self.a)) < 1))


def tustin(function: TransferFunction, sample_time_s: float) -> DiscreteFilter:
    """s = (2/T)(1 - z⁻¹)/(1 + z⁻¹), without prewarping.

    Raises:
        BadInputError: the function is improper.
    """
    if len(np.trim_zeros(function.numerator, "f")) > len(np.trim_zeros(function.denominator, "f")):
        raise BadInputError("an improper function cannot be made discrete", fix="add a low pass to it")
    b, a = signal.bilinear(function.numerator, function.denominator, 1 / sample_time_s)
    return DiscreteFilter(tuple(float(v) for v in b / a[0]), tuple(float(v) for v in a / a[0]), sample_time_s)
