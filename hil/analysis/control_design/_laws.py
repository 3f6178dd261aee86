"""The controller's parts as the paper writes them in continuous time, and by Tustin's rule as in the RMCU.

Equation numbers are the paper's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.core.controller import Lead, Notch, Wsc
from hil.core.errors import BadInputError
from hil.core.model import TransferFunction
from hil.plant.controller.filters import discretised

Normalisation = Literal["dc", "centre", "high_frequency"]


def pole_assignment(inertia_kg_m2: float, pole_rad_s: float) -> tuple[float, float]:
    """K_p in N m s/rad and K_i in N m/rad by (4)(5) for a double pole at -|p|.

    The paper gives p = 0.3 rad/s where its own (4) needs -0.3: the magnitude is meant.

    Args:
        inertia_kg_m2: J_l/N² + J_m, rotor side.
        pole_rad_s: p; its sign does not matter.
    """
    p = abs(pole_rad_s)
    return 2 * inertia_kg_m2 * p, inertia_kg_m2 * p * p


def lead(angle_deg: float, frequency_hz: float, normalisation: Normalisation = "high_frequency") -> Lead:
    """Phase lead with P_h at f_ph by (6)(7).

    Raises:
        BadInputError: P_h outside 0 to 85 degrees or f_ph not positive.
    """
    if not 0 <= angle_deg <= 85 or not frequency_hz > 0:
        raise BadInputError(
            f"a lead of {angle_deg:g} degrees at {frequency_hz:g} Hz cannot be made",
            fix="the angle lies from 0 to 85 degrees, the frequency above 0",
        )
    sine = math.sin(math.radians(angle_deg))
    alpha = (1 - sine) / (1 + sine)
    return Lead(
        alpha=alpha,
        time_constant_s=1 / (2 * math.pi * math.sqrt(alpha) * frequency_hz),
        normalisation=normalisation,
    )


def lead_function(part: Lead) -> TransferFunction:
    """gain·(T s + 1)/(α T s + 1)."""
    t = part.time_constant_s
    return TransferFunction((part.gain * t, part.gain), (part.alpha * t, 1.0))


def notch_function(part: Notch) -> TransferFunction:
    """(8): (s² + 4π f_n ζ d s + ω_n²)/(s² + 4π f_n ζ s + ω_n²), ω_n = 2π f_n."""
    omega = 2 * math.pi * part.frequency_hz
    damping = 2 * omega * part.width
    return TransferFunction((1.0, damping * part.depth, omega**2), (1.0, damping, omega**2))


def feedback_functions(wsc: Wsc) -> tuple[TransferFunction, ...]:
    """The blocks of the wheel speed control's feedback, in series: PI, then lead or notch."""
    blocks = [TransferFunction((wsc.proportional_gain, wsc.integral_gain), (1.0, 0.0))]
    if wsc.lead is not None:
        blocks.append(lead_function(wsc.lead))
    if wsc.notch is not None:
        blocks.append(notch_function(wsc.notch))
    return tuple(blocks)


def speed_filter(
    motor: TransferFunction, wheel: TransferFunction, time_constant_s: float
) -> TransferFunction:
    """G_WSC of (17): motor speed over wheel speed, times 1/(τ_1 s + 1); dead times cancel."""
    return _cancelled(motor.numerator, wheel.numerator, time_constant_s)


def feed_forward(shaft_torque: TransferFunction, time_constant_s: float) -> TransferFunction:
    """G_FF of (18): the inverse of shaft torque over motor torque, times 1/(τ_2 s + 1), no dead time."""
    return _cancelled(shaft_torque.denominator, shaft_torque.numerator, time_constant_s)


def observer_filter(time_constant_s: float) -> TransferFunction:
    """Low pass of the driving force observer (13), 1/(τ_DFO s + 1)."""
    return TransferFunction((1.0,), (time_constant_s, 1.0))


def _cancelled(
    numerator: tuple[float, ...], denominator: tuple[float, ...], time_constant_s: float
) -> TransferFunction:
    """numerator/denominator/(τ s + 1) without the zeros at the origin that both share."""
    top, bottom = np.trim_zeros(np.array(numerator), "f"), np.trim_zeros(np.array(denominator), "f")
    while top[-1] == 0 and bottom[-1] == 0:
        top, bottom = top[:-1], bottom[:-1]
    bottom = np.polymul(bottom, [time_constant_s, 1.0])
    return TransferFunction(tuple(float(c) for c in top), tuple(float(c) for c in bottom))


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
