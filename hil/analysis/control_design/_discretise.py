"""The RMCU's arithmetic: each block by Tustin's rule at the controller's sample time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.model import TransferFunction
from hil.plant.controller.filters import discretised

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
    """What the RMCU makes of a function: Tustin's rule without prewarping, common roots at s = 0 cancelled.

    Raises:
        BadInputError: the function is improper, or of too high an order for the RMCU.
    """
    try:
        b, a = discretised(function.numerator, function.denominator, sample_time_s)
    except ValueError as error:
        raise BadInputError(
            f"a block cannot be made discrete: {error}",
            fix="give each block a denominator of its numerator's order or more, and not of a high one",
        ) from error
    return DiscreteFilter(tuple(map(float, b)), tuple(map(float, a)), sample_time_s)
