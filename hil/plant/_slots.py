"""Where each number of a model stands in the kernel's parameter vector."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.model import Model

# Kept literal and in this file: compiled kernels are cached by source file, and their indices are constants.
NAMES = (
    "kind",
    "motor_inertia",
    "gear_ratio",
    "shaft_stiffness",
    "shaft_damping",
    "wheel_inertia",
    "tyre_stiffness",
    "tyre_damping",
    "vehicle_inertia",
    "torque_delay",
    "actuator_lag.time_constant_s",
    "torque_saturation.limit_nm",
    "torque_rate_limit.limit_nm_s",
    "torque_deadband.half_width_nm",
    "backlash.half_gap_rad",
    "shaft_cubic_stiffness.coefficient_nm_rad3",
    "shaft_hysteresis.stiffness_nm_rad",
    "shaft_hysteresis.slip_rad",
    "coulomb_friction.torque_nm",
    "coulomb_friction.stribeck_torque_nm",
    "coulomb_friction.offset_nm",
    "viscous_drag.coefficient_nms_rad",
    "mount_mode.housing_inertia_kg_m2",
    "mount_mode.mount_stiffness_nm_rad",
    "mount_mode.mount_damping_nms_rad",
    "wheel_order_disturbance.order",
    "wheel_order_disturbance.amplitude_nm",
    "wheel_order_disturbance.phase_rad",
    "motor_order_ripple.order",
    "motor_order_ripple.amplitude_nm",
    "motor_order_ripple.phase_rad",
    "running_resistance.rolling_nm",
    "running_resistance.aero_nms2_rad2",
)
(
    KIND,
    MOTOR_INERTIA,
    GEAR_RATIO,
    SHAFT_STIFFNESS,
    SHAFT_DAMPING,
    WHEEL_INERTIA,
    TYRE_STIFFNESS,
    TYRE_DAMPING,
    VEHICLE_INERTIA,
    TORQUE_DELAY,
    LAG,
    SATURATION,
    RATE_LIMIT,
    DEADBAND,
    HALF_GAP,
    CUBIC,
    HYSTERESIS_STIFFNESS,
    HYSTERESIS_SLIP,
    COULOMB,
    STRIBECK,
    FRICTION_OFFSET,
    DRAG,
    HOUSING_INERTIA,
    MOUNT_STIFFNESS,
    MOUNT_DAMPING,
    WHEEL_ORDER,
    WHEEL_ORDER_AMPLITUDE,
    WHEEL_ORDER_PHASE,
    MOTOR_ORDER,
    MOTOR_ORDER_AMPLITUDE,
    MOTOR_ORDER_PHASE,
    ROLLING,
    AERO,
) = range(33)

RIGID, TWO_INERTIA, THREE_INERTIA = 0.0, 1.0, 2.0
_KINDS = {"rigid": RIGID, "two_inertia": TWO_INERTIA, "three_inertia": THREE_INERTIA}
_INDEX = {name: index for index, name in enumerate(NAMES)}
_OFF_WHEN_INFINITE = (SATURATION, RATE_LIMIT)
_SENSOR_EFFECTS = ("sensor_gain", "sensor_offset", "channel_skew", "sensor_quantization")


def pack(model: Model) -> npt.NDArray[np.float64]:
    """Parameter vector of a mechanical model.

    Raises:
        BadInputError: an effect stands twice where the kernel has one place for it.
    """
    vector = np.zeros(len(NAMES))
    vector[list(_OFF_WHEN_INFINITE)] = np.inf
    vector[KIND] = _KINDS[model.kind]
    for name, value in model.parameters.items():
        vector[_slot(name)] = value
    seen: set[str] = set()
    for use in model.effects:
        if use.id in _SENSOR_EFFECTS or use.id == "parameter_mismatch":
            continue
        if use.id in seen:
            raise BadInputError(f"effect '{use.id}' stands twice", fix="merge the two [[effects]] tables")
        seen.add(use.id)
        _place(vector, use.id, {name: float(value) for name, value in use.values.items()})
    for use in model.effects:
        if use.id == "parameter_mismatch":
            vector[_slot(str(use.values["parameter"]))] = float(use.values["value"])
    return vector


def _slot(parameter: str) -> int:
    """Where a parameter of a model stands; the drag of a rigid one is that of the effect."""
    return _INDEX["viscous_drag.coefficient_nms_rad" if parameter == "viscous_drag" else parameter]


def _place(vector: npt.NDArray[np.float64], effect: str, values: dict[str, float]) -> None:
    if effect == "dead_time":
        vector[TORQUE_DELAY] = max(0.0, vector[TORQUE_DELAY] + values["extra_delay_s"])
    elif effect == "tyre_compliance":
        # The two-inertia model counts the wheels with the vehicle: what becomes wheel is taken from there.
        vector[KIND] = THREE_INERTIA
        for name, value in values.items():
            vector[_INDEX[name]] = value
        vector[VEHICLE_INERTIA] = max(vector[VEHICLE_INERTIA] - values["wheel_inertia"], 1e-6)
    elif effect == "viscous_drag":
        vector[DRAG] += values["coefficient_nms_rad"]
    else:
        for name, value in values.items():
            vector[_INDEX[f"{effect}.{name}"]] = value
