"""DFO: driving force observer, the paper's Fig. 4."""

from __future__ import annotations

from hil.core.runtime.compiled import compiled
from hil.plant.controller import memory as M
from hil.plant.controller.filters import step, tustin


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
