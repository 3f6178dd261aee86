"""Where each number of a model stands in the kernels' parameter vector."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.plant._table import Table

if TYPE_CHECKING:
    from hil.core.model import Model

SLOTS = Table()
#: Slots on which a held step of the linear part depends; the others are forces, or shape the torque.
LINEAR: list[int] = []
_slot = SLOTS.place


def _linear(name: str, unit: str, meaning: str) -> int:
    LINEAR.append(SLOTS.place(name, unit, meaning))
    return LINEAR[-1]


KIND = _linear("kind", "1", "which chain: RIGID, TWO_INERTIA or THREE_INERTIA")
MOTOR_INERTIA = _linear("motor_inertia", "kg m²", "of the rotor")
GEAR_RATIO = _linear("gear_ratio", "1", "motor speed over wheel speed")
SHAFT_STIFFNESS = _linear("shaft_stiffness", "N m/rad", "of both shafts, wheel side")
SHAFT_DAMPING = _linear("shaft_damping", "N m s/rad", "of both shafts, wheel side")
WHEEL_INERTIA = _linear("wheel_inertia", "kg m²", "of wheels and dyno rotors")
TYRE_STIFFNESS = _linear("tyre_stiffness", "N m/rad", "of the tyre/road coupling")
TYRE_DAMPING = _linear("tyre_damping", "N m s/rad", "of the tyre/road coupling")
VEHICLE_INERTIA = _linear("vehicle_inertia", "kg m²", "of the vehicle, or of all that is not the rotor")
TORQUE_DELAY = _linear("torque_delay", "s", "dead time of the torque path")
LAG = _linear("actuator_lag.time_constant_s", "s", "of the acting torque behind the requested")
SATURATION = _slot("torque_saturation.limit_nm", "N m", "the acting torque's limit; infinite: none")
RATE_LIMIT = _slot("torque_rate_limit.limit_nm_s", "N m/s", "steepest slope of the acting torque")
DEADBAND = _slot("torque_deadband.half_width_nm", "N m", "largest request that does nothing")
HALF_GAP = _slot("backlash.half_gap_rad", "rad", "half of the free play, wheel side")
CUBIC = _slot("shaft_cubic_stiffness.coefficient_nm_rad3", "N m/rad³", "shaft torque over twist cubed")
HYSTERESIS_STIFFNESS = _slot("shaft_hysteresis.stiffness_nm_rad", "N m/rad", "of the path beside the shafts")
HYSTERESIS_SLIP = _slot("shaft_hysteresis.slip_rad", "rad", "where that path slips")
COULOMB = _slot("coulomb_friction.torque_nm", "N m", "dry friction, rotor side")
STRIBECK = _slot("coulomb_friction.stribeck_torque_nm", "N m", "what friction has more of at standstill")
FRICTION_OFFSET = _slot("coulomb_friction.offset_nm", "N m", "asymmetry of friction")
DRAG = _linear("viscous_drag.coefficient_nms_rad", "N m s/rad", "over rotor speed")
HOUSING_INERTIA = _linear("mount_mode.housing_inertia_kg_m2", "kg m²", "of the housing; 0: it stands still")
MOUNT_STIFFNESS = _linear("mount_mode.mount_stiffness_nm_rad", "N m/rad", "of the bushes")
MOUNT_DAMPING = _linear("mount_mode.mount_damping_nms_rad", "N m s/rad", "of the bushes")
WHEEL_ORDER = _slot("wheel_order_disturbance.order", "1/rev", "periods per turn of the wheel")
WHEEL_ORDER_AMPLITUDE = _slot("wheel_order_disturbance.amplitude_nm", "N m", "of the shaft torque's ripple")
WHEEL_ORDER_PHASE = _slot("wheel_order_disturbance.phase_rad", "rad", "at wheel angle 0")
MOTOR_ORDER = _slot("motor_order_ripple.order", "1/rev", "periods per turn of the rotor")
MOTOR_ORDER_AMPLITUDE = _slot("motor_order_ripple.amplitude_nm", "N m", "of the rotor's ripple")
MOTOR_ORDER_PHASE = _slot("motor_order_ripple.phase_rad", "rad", "at rotor angle 0")
ROLLING = _slot("running_resistance.rolling_nm", "N m", "load on the vehicle that does not depend on speed")
AERO = _slot("running_resistance.aero_nms2_rad2", "N m s²/rad²", "load on the vehicle over its speed squared")

RIGID, TWO_INERTIA, THREE_INERTIA = 0.0, 1.0, 2.0
_KINDS = {"rigid": RIGID, "two_inertia": TWO_INERTIA, "three_inertia": THREE_INERTIA}
_INDEX = {name: index for index, name in enumerate(SLOTS.names)}
_OFF_WHEN_INFINITE = (SATURATION, RATE_LIMIT)
_SENSOR_EFFECTS = ("sensor_gain", "sensor_offset", "channel_skew", "sensor_quantization")


def pack(model: Model) -> npt.NDArray[np.float64]:
    """Parameter vector of a mechanical model.

    Raises:
        BadInputError: an effect stands twice where the kernel has one place for it.
    """
    vector = np.zeros(len(SLOTS))
    vector[list(_OFF_WHEN_INFINITE)] = np.inf
    vector[KIND] = _KINDS[model.kind]
    for name, value in model.parameters.items():
        vector[_place_of(name)] = value
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
            vector[_place_of(str(use.values["parameter"]))] = float(use.values["value"])
    return vector


def _place_of(parameter: str) -> int:
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
