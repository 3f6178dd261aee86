"""WSC: wheel speed control, the red part of the paper's Fig. 3."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from hil.core.runtime.compiled import compiled
from hil.plant.controller import memory as M
from hil.plant.controller.filters import Filter, step, tustin


class SpeedFilter:
    """G_WSC (17): ω_m*/ω_l* from the identified functions (14)/(15), with 1/(τ_1 s + 1)."""

    def __init__(
        self, tau_1: float, motor_speed: npt.ArrayLike, wheel_speed: npt.ArrayLike, sample_time_s: float
    ) -> None:
        self.filter = tustin(
            motor_speed, np.convolve(np.asarray(wheel_speed, dtype=float), [tau_1, 1.0]), sample_time_s
        )


class PhaseLead:
    """Phase stabilization (6)(7): gain·(T s + 1)/(α T s + 1)."""

    def __init__(self, gain: float, alpha: float, t: float, sample_time_s: float) -> None:
        self.filter = tustin([gain * t, gain], [alpha * t, 1.0], sample_time_s)


class Notch:
    """Gain stabilization (8)."""

    def __init__(self, f_n: float, zeta: float, d: float, sample_time_s: float) -> None:
        w = 2.0 * math.pi * f_n
        self.filter = tustin([1.0, 2.0 * w * zeta * d, w * w], [1.0, 2.0 * w * zeta, w * w], sample_time_s)


class WheelSpeedControl:
    """PI by pole assignment (4)(5) on the motor speed, in series with a lead, a notch, or neither."""

    def __init__(
        self, k_p: float, k_i: float, speed_filter: SpeedFilter, stabilizer: PhaseLead | Notch | None
    ) -> None:
        self._k_p, self._k_i = k_p, k_i
        self._speed_filter = speed_filter.filter
        self._stabilizer: Filter = stabilizer.filter if stabilizer else tustin([1.0], [1.0], 1.0)

    def load(self, memory: M.Memory) -> None:
        """Put coefficients into the firmware's memory."""
        memory.place(M.SPEED_FILTER, self._speed_filter)
        memory.place(M.STABILIZER, self._stabilizer)
        memory.gains[M.K_P], memory.gains[M.K_I] = self._k_p, self._k_i


@compiled
def motor_torque(b, a, z, k, s, wheel_speed_reference, w_m, hold, factor):  # type: ignore[no-untyped-def]
    """T_m(WSC)* in N m: filter (17), PI (4)(5), lead (6)(7) or notch (8).

    `hold` freezes the integrator, `factor` is of both gains.
    """
    reference = step(b[M.SPEED_FILTER], a[M.SPEED_FILTER], z[M.SPEED_FILTER], wheel_speed_reference)
    error = reference - w_m
    s[M.SPEED_ERROR] = error
    if not hold:
        s[M.INTEGRATOR] += factor * k[M.K_I] * error * k[M.SAMPLE_TIME]
    pi = factor * k[M.K_P] * error + s[M.INTEGRATOR]
    return step(b[M.STABILIZER], a[M.STABILIZER], z[M.STABILIZER], pi)
