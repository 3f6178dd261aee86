"""The arrays that the compiled loop works on, as they are when a bench is switched on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.model import Model
from hil.plant import _equations as E
from hil.plant import _kernel as K
from hil.plant import _slots as P
from hil.plant.closed_loop import drive as D
from hil.plant.closed_loop import tick as T

Array = npt.NDArray[np.float64]

# What each sensor of a tick measures: one at the motor, one a side at wheels and shafts.
_SENSED = (
    "motor_speed_rad_s",
    "wheel_speed_rad_s",
    "wheel_speed_rad_s",
    "shaft_torque_nm",
    "shaft_torque_nm",
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
        BadInputError: an effect stands twice where there is one place for it.
    """
    vector = P.pack(model)
    scalars = np.zeros(T.SCALARS)
    scalars[T.RADIUS] = wheel_radius_m
    three = vector[P.KIND] == P.THREE_INERTIA
    scalars[T.DRIVE_INERTIA] = vector[P.WHEEL_INERTIA if three else P.VEHICLE_INERTIA]
    return State(
        x=np.zeros(E.STATES),
        vector=vector,
        scalars=scalars,
        torques=np.zeros(T.HISTORY),
        drives=np.zeros((2, D.COLUMNS)),
        sensors=_sensors(model),
        past=np.zeros((T.SENSORS, T.HISTORY)),
        noise=np.zeros(T.SENSORS + K.OUTPUT_COLUMNS),  # behind the noise is the tick's scratch room
    )


def _sensors(model: Model) -> Array:
    sensors = np.zeros((T.SENSORS, 4))
    sensors[:, T.SENSOR_GAIN] = 1.0
    for use in model.effects:
        for row, channel in zip(sensors, _SENSED, strict=True):
            if use.values.get("channel") == channel:
                _apply(row, channel, use.id, use.values)
    return sensors


def _apply(row: Array, channel: str, effect: str, values: dict[str, float | str]) -> None:
    sides = 2.0 if channel == "shaft_torque_nm" else 1.0  # each side reads half of the sum
    if effect == "sensor_gain":
        row[T.SENSOR_GAIN] *= float(values["gain"])
    elif effect == "sensor_offset":
        row[T.SENSOR_OFFSET] += float(values["offset"]) / sides
    elif effect == "sensor_quantization":
        row[T.SENSOR_STEP] = float(values["step"]) / sides
    elif effect == "channel_skew":
        row[T.SENSOR_DELAY] = max(0.0, float(values["delay_s"]))
