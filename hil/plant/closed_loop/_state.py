"""The arrays that the compiled loop works on, as they are when a bench is switched on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.model import Model
from hil.plant import _kernel as K
from hil.plant import _slots as P
from hil.plant import _states as X
from hil.plant import bench_sensor
from hil.plant.closed_loop import drive as D
from hil.plant.closed_loop import tick as T

Array = npt.NDArray[np.float64]

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
    vector: Array
    scalars: Array
    torques: Array
    drives: Array
    sensors: Array
    past: Array
    noise: Array


def state_at_rest(model: Model, wheel_radius_m: float) -> State:
    """An axle at rest with its drives free and its sensors without noise.

    Raises:
        BadInputError: an effect stands twice where there is one place for it, or a sensor is early.
    """
    vector = P.pack(model)
    scalars = np.zeros(T.SCALARS)
    scalars[T.RADIUS] = wheel_radius_m
    three = vector[P.KIND] == P.THREE_INERTIA
    scalars[T.DRIVE_INERTIA] = vector[P.WHEEL_INERTIA if three else P.VEHICLE_INERTIA]
    return State(
        x=np.zeros(X.ALL_STATES),
        vector=vector,
        scalars=scalars,
        torques=np.zeros(T.HISTORY),
        drives=np.zeros((2, D.COLUMNS)),
        sensors=np.array([bench_sensor(model, channel, share) for channel, share in _SENSED]),
        past=np.zeros((T.SENSORS, T.HISTORY)),
        noise=np.zeros(T.SENSORS + K.OUTPUT_COLUMNS),  # behind the noise is the tick's scratch room
    )
