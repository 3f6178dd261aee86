"""The arrays that the compiled loop works on, as they are when a bench is switched on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.model import Model
from hil.plant import LONGEST_STEP_S, bench_sensor, refuse_diverged_state, refuse_too_stiff
from hil.plant import kernel as K
from hil.plant import sides as S
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant.closed_loop import drive as D
from hil.plant.closed_loop import tick as T

Array = npt.NDArray[np.float64]
_ROLLING = P.place("running_resistance", "rolling_nm")
_PEAK, _ROAD = P.place("tyre_friction", "peak_nm"), P.place("tyre_friction", "road_friction")
_AERO = P.place("running_resistance", "aero_nms2_rad2")

# What each sensor of a tick measures, and its share of it: each side's shaft has half of the torque.
_SENSED = (
    ("motor_speed_rad_s", 1.0),
    ("wheel_speed_rad_s", 1.0),
    ("wheel_speed_rad_s", 1.0),
    ("shaft_torque_nm", 0.5),
    ("shaft_torque_nm", 0.5),
)


@dataclass(frozen=True)
class State:
    """Everything of a bench that a tick reads or moves, but for the RMCU's memory."""

    x: Array
    form: tuple[float, ...]
    vector: Array
    scalars: Array
    torques: Array
    drives: Array
    sensors: Array
    past: Array
    noise: Array
    source: str  # of the model

    def refuse_diverged(self, time_s: float) -> None:
        """Look at what came out, at a bench time in seconds.

        Raises:
            BadInputError: numbers that no axle has: names the model.
        """
        refuse_diverged_state(self.x, time_s, self.source, float(self.scalars[T.LONGEST_STEP]))

    def stand_still(self) -> None:
        """Be at rest from now on, with the drives free: for what goes on after the numbers are none."""
        self.x[:] = self.torques[:] = self.past[:] = 0.0
        self.drives[:, D.MODE] = D.FREE

    @property
    def has_friction(self) -> bool:
        """Whether the tyres hold no more than the road's friction allows."""
        return bool(self.vector[_PEAK] > 0.0)

    @property
    def vehicle(self) -> tuple[float, float, float]:
        """Inertia (kg m²), rolling (N m) and aerodynamic resistance (N m s²/rad²) of the vehicle model."""
        p = self.vector
        return float(p[P.VEHICLE_INERTIA]), float(p[_ROLLING]), float(p[_AERO])

    def set_vehicle(
        self,
        *,
        inertia_kg_m2: float | None = None,
        rolling_nm: float | None = None,
        aero_nms2_rad2: float | None = None,
        slip: float | None = None,
        wheel_radius_m: float | None = None,
        initial_speed_m_s: float | None = None,
        friction_left: float | None = None,
        friction_right: float | None = None,
    ) -> None:
        """Change what the drives' vehicle model is set to; None leaves a value as it is.

        Friction is a share of what the tyres hold on a dry road; sides that are lumped have their mean.
        """
        for array, index, value in (
            (self.vector, P.VEHICLE_INERTIA, inertia_kg_m2),
            (self.vector, _ROLLING, rolling_nm),
            (self.vector, _AERO, aero_nms2_rad2),
            (self.scalars, T.SLIP, slip),
            (self.scalars, T.RADIUS, wheel_radius_m),
            (self.scalars, T.INITIAL_SPEED, initial_speed_m_s),
            (self.vector, S.FRICTION_LEFT, friction_left),
            (self.vector, S.FRICTION_RIGHT, friction_right),
        ):
            if value is not None:
                array[index] = value
        if len(self.form) == len(S.LUMPED) and (friction_left, friction_right) != (None, None):
            self.vector[_ROAD] = 0.5 * (self.vector[S.FRICTION_LEFT] + self.vector[S.FRICTION_RIGHT])


def state_at_rest(model: Model, wheel_radius_m: float, longest_step_s: float = LONGEST_STEP_S) -> State:
    """An axle at rest with its drives free and its sensors without noise; `longest_step_s`: the integrator's.

    Raises:
        BadInputError: an effect stands twice where there is one place for it, a sensor is early, or the
            model is too stiff for the integrator.
    """
    refuse_too_stiff(model, longest_step_s)
    vector = P.pack(model)
    form = S.form_of(model)
    if form is S.LUMPED:  # both sides are on the model's road
        vector[[S.FRICTION_LEFT, S.FRICTION_RIGHT]] = vector[_ROAD] or 1.0
    scalars = np.zeros(T.SCALARS)
    scalars[T.RADIUS] = wheel_radius_m
    scalars[T.LONGEST_STEP] = longest_step_s
    three = vector[P.KIND] == P.THREE_INERTIA
    scalars[T.DRIVE_INERTIA] = vector[P.WHEEL_INERTIA if three else P.VEHICLE_INERTIA]
    return State(
        x=np.zeros(X.ALL_STATES - X.MOVING + len(form)),
        form=form,
        vector=vector,
        scalars=scalars,
        torques=np.zeros(T.HISTORY),
        drives=np.zeros((2, D.COLUMNS)),
        sensors=np.array([bench_sensor(model, channel, share) for channel, share in _SENSED]),
        past=np.zeros((T.SENSORS, T.PAST)),
        noise=np.zeros(T.SENSORS + K.OUTPUT_COLUMNS),  # behind the noise is the tick's scratch room
        source=model.source,
    )
