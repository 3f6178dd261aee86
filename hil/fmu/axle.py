"""An axle in its vehicle, with or without its controller, stepped by somebody else: what a unit computes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from drivers import parameters_of
from hil.core.can.signals import Signal
from hil.core.channels import TICK_S
from hil.core.controller import Controller
from hil.core.errors import BadInputError
from hil.core.model import Model, refuse_without_vehicle
from hil.plant.closed_loop import SIDES, ClosedLoop, Wire
from hil.plant.closed_loop import drive as D
from hil.plant.closed_loop import tick as T
from hil.plant.controller import memory as M

#: What a unit gives, with units, descriptions, and columns of the closed loop of which it is the sum.
OUTPUTS: dict[str, tuple[str, str, tuple[int, ...], float]] = {
    "motor_speed_rad_s": ("rad/s", "motor speed", (T.MOTOR_SPEED,), 1.0),
    "wheel_speed_rad_s": ("rad/s", "mean wheel speed", (T.WHEEL_LEFT, T.WHEEL_RIGHT), 0.5),
    "shaft_torque_nm": ("N.m", "shaft torque, left plus right", (T.SHAFT_LEFT, T.SHAFT_RIGHT), 1.0),
    "vehicle_speed_m_s": ("m/s", "vehicle speed", (T.VEHICLE_SPEED,), 1.0),
    "motor_torque_ref_nm": ("N.m", "torque asked of the inverter", (T.TORQUE_REF,), 1.0),
    "motor_torque_nm": ("N.m", "motor torque", (T.TORQUE,), 1.0),
    "driving_torque_est_nm": ("N.m", "driving torque by the observer", (T.DRIVING_EST,), 1.0),
}
_SIDES = {
    "wheel_speed_rad_s": (T.WHEEL_LEFT, T.WHEEL_RIGHT),
    "shaft_torque_nm": (T.SHAFT_LEFT, T.SHAFT_RIGHT),
    "dyno_torque_nm": (T.LOAD_LEFT, T.LOAD_RIGHT),
}
_EXACT = Signal("exact", 0, 64, is_float=True)  # nothing rounds here
_RAMP_RAD_S2 = 40.0
_SETTLES_S = 1.0
_LONGEST_RAMP_S = 60.0
_NEAR_RAD_S = 0.05
_LOOKED_AT = 250  # of the samples


class Axle:
    """Steps of whole milliseconds, as the RMCU's control runs.

    Args:
        controller: without it the torque that is asked for is the motor's.
        initial_speed_m_s: of the vehicle, which the wheels are driven to beforehand.

    Raises:
        BadInputError: a model without a vehicle, or a speed that the wheels do not come to.
        BenchError: the RMCU would refuse the controller.
    """

    def __init__(
        self,
        model: Model,
        controller: Controller | None = None,
        wheel_radius_m: float = 0.33,
        initial_speed_m_s: float = 0.0,
    ) -> None:
        refuse_without_vehicle(model, "model", "make the unit")
        self._loop = ClosedLoop(model, wheel_radius_m, Wire({}, _EXACT, _EXACT, _EXACT))
        self._mode = M.TORQUE if controller is None else M.DRIVING_FORCE
        if controller is not None:
            self._loop.set_controller(parameters_of(controller))
        self._drive_to(initial_speed_m_s / wheel_radius_m)
        self._loop.plant.set_vehicle(initial_speed_m_s=initial_speed_m_s)
        for side in SIDES:
            self._loop.drive_mode(side, D.VEHICLE)
        self.torque_nm = 0.0

    def step(self, duration_s: float) -> None:
        """Let time pass; `torque_nm` is asked for meanwhile.

        Raises:
            BadInputError: no whole number of milliseconds.
        """
        samples = round(duration_s / TICK_S)
        if samples < 1 or abs(samples * TICK_S - duration_s) > 1e-6 * TICK_S * max(1, samples):
            raise BadInputError(
                f"a step of {duration_s:g} s", fix="take a whole number of milliseconds: the control's cycle"
            )
        self._loop.play(self._mode, np.full(samples, self.torque_nm))

    def play(self, torque_nm: npt.NDArray[np.float64]) -> dict[str, npt.NDArray[np.float64]]:
        """Ask for one value each millisecond; what was measured in each, by the names of `OUTPUTS`."""
        before = self._loop.samples
        self._loop.play(self._mode, torque_nm)
        rows = self._loop.rows[before:]
        return {
            name: share * rows[:, list(columns)].sum(axis=1)
            for name, (_, _, columns, share) in OUTPUTS.items()
        }

    def play_sides(self, torque_nm: npt.NDArray[np.float64]) -> dict[str, npt.NDArray[np.float64]]:
        """As `play`; what was measured at each side, of shape (samples, 2), left and right.

        Wheel speed, shaft torque, and the torque that each dynamometer, or tyre, takes: `dyno_torque_nm`.
        """
        before = self._loop.samples
        self._loop.play(self._mode, torque_nm)
        rows = self._loop.rows[before:]
        return {name: rows[:, list(columns)] for name, columns in _SIDES.items()}

    def outputs(self) -> Mapping[str, float]:
        """The sample of this moment, by name, if `torque_nm` goes on being asked for."""
        row = self._loop.next_row(self._mode, self.torque_nm)
        return {
            name: share * float(sum(row[c] for c in columns))
            for name, (_, _, columns, share) in OUTPUTS.items()
        }

    def _drive_to(self, speed_rad_s: float) -> None:
        """As a bench does: the drives bring the wheels there and hold them."""
        if not speed_rad_s:
            return
        loop = self._loop
        loop.set_ramp(_RAMP_RAD_S2)
        for side in SIDES:
            loop.drive_mode(side, D.SPEED)
            loop.target_speed(side, speed_rad_s)
        loop.run(round((min(abs(speed_rad_s) / _RAMP_RAD_S2, _LONGEST_RAMP_S) + _SETTLES_S) / TICK_S))
        reached = float(np.mean(loop.rows[-_LOOKED_AT:, T.WHEEL_LEFT]))  # wheels may be out of round
        if abs(reached - speed_rad_s) > max(_NEAR_RAD_S, 0.01 * abs(speed_rad_s)):
            raise BadInputError(
                f"initial_speed_m_s: the wheels come to {reached:.3g} rad/s, not {speed_rad_s:.3g}",
                fix="begin slower",
            )
