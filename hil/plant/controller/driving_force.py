"""DFC and DFO, driving force control and observer: the blue part of the paper's Fig. 3, and its Fig. 4."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.runtime.compiled import compiled
from hil.plant.controller import memory as M
from hil.plant.controller.filters import step, tustin


class DrivingForceControl:
    """Feed-forward (18) and integral feedback with (1)(2).

    Args:
        k_i: K_i(DFC); tau_2: τ_2 in s; r: wheel radius in m; sigma: σ in m/s; slip_limit: largest |y|.
        shaft_torque, denominator: T_s/T_m* (16) without its dead time, descending powers of s.
    """

    def __init__(
        self,
        k_i: float,
        tau_2: float,
        r: float,
        sigma: float,
        slip_limit: float,
        shaft_torque: npt.ArrayLike,
        denominator: npt.ArrayLike,
        sample_time_s: float,
    ) -> None:
        self._gains = {M.K_I_DFC: k_i, M.RADIUS: r, M.SIGMA: sigma, M.SLIP_LIMIT: slip_limit}
        # (18): G_FF = T_m*/T_s · 1/(τ_2 s + 1)
        self._feedforward = tustin(
            denominator, np.convolve(np.asarray(shaft_torque, dtype=float), [tau_2, 1.0]), sample_time_s
        )

    def load(self, memory: M.Memory) -> None:
        """Put coefficients into the firmware's memory."""
        memory.place(M.FEEDFORWARD, self._feedforward)
        for index, value in self._gains.items():
            memory.gains[index] = value


@compiled
def feedforward(b, a, z, reference):  # type: ignore[no-untyped-def]
    """T_m(DFC)* in N m for rF_d* (18)."""
    return step(b[M.FEEDFORWARD], a[M.FEEDFORWARD], z[M.FEEDFORWARD], reference)


@compiled
def wheel_speed_reference(k, s, reference, estimate, v_hat, hold, factor):  # type: ignore[no-untyped-def]
    """ω_l* in rad/s: y integrates the driving torque's error, (1) gives V*, (2) divides by r.

    `factor` is of K_i(DFC).
    """
    if not hold:
        y = s[M.SLIP] + factor * k[M.K_I_DFC] * (reference - estimate) * k[M.SAMPLE_TIME]
        s[M.SLIP] = min(max(y, -k[M.SLIP_LIMIT]), k[M.SLIP_LIMIT])
    base = v_hat if v_hat >= k[M.SIGMA] else k[M.SIGMA]
    return (v_hat + s[M.SLIP] * base) / k[M.RADIUS]


class DrivingForceObserver:
    """(9)-(13): rF̂_d = T_m N - J_l ω̇_m/N behind a first-order low pass.

    J_l is the inertia between T_s and the road: wheels and dyno rotors.
    """

    def __init__(self, tau_dfo: float, n: float, j_l: float, sample_time_s: float) -> None:
        self._torque = tustin([n], [tau_dfo, 1.0], sample_time_s)
        self._speed = tustin([j_l / n, 0.0], [tau_dfo, 1.0], sample_time_s)

    def load(self, memory: M.Memory) -> None:
        """Put coefficients into the firmware's memory."""
        memory.place(M.OBSERVER_TORQUE, self._torque)
        memory.place(M.OBSERVER_SPEED, self._speed)


@compiled
def estimate(b, a, z, t_m, w_m):  # type: ignore[no-untyped-def]
    """rF̂_d in N m (13), low-pass filtered."""
    torque = step(b[M.OBSERVER_TORQUE], a[M.OBSERVER_TORQUE], z[M.OBSERVER_TORQUE], t_m)
    return torque - step(b[M.OBSERVER_SPEED], a[M.OBSERVER_SPEED], z[M.OBSERVER_SPEED], w_m)
