"""Noise of the bench's sensors: white, normal, the same for the same seed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


class Noise:
    """Standard deviations of motor speed, wheel speeds (rad/s) and each side's shaft torque (N m)."""

    def __init__(
        self, motor_speed_rad_s: float, wheel_speed_rad_s: float, shaft_torque_nm: float, seed: int
    ) -> None:
        self._scale = np.array(
            [motor_speed_rad_s, *[wheel_speed_rad_s] * 2, *[shaft_torque_nm] * 2], np.float64
        )
        self._random = np.random.default_rng(seed)

    def drawn(self, samples: int) -> Array:
        """The next samples, a column for each sensor of the tick."""
        return self._random.standard_normal((samples, len(self._scale))) * self._scale
