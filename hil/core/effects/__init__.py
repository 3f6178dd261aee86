"""The registry of physical effects: one file an effect, one object a file."""

from hil.core.effects import (
    actuator_lag,
    backlash,
    channel_skew,
    coulomb_friction,
    dead_time,
    motor_order_ripple,
    mount_mode,
    parameter_mismatch,
    running_resistance,
    sensor_gain,
    sensor_offset,
    sensor_quantization,
    shaft_cubic_stiffness,
    shaft_hysteresis,
    torque_deadband,
    torque_rate_limit,
    torque_saturation,
    tyre_compliance,
    viscous_drag,
    wheel_order_disturbance,
)
from hil.core.effects._effect import SENSED, Effect, Parameter, Stage, finite_number, shown

_MODULES = (
    dead_time,
    actuator_lag,
    torque_saturation,
    torque_rate_limit,
    torque_deadband,
    backlash,
    shaft_cubic_stiffness,
    shaft_hysteresis,
    coulomb_friction,
    viscous_drag,
    mount_mode,
    tyre_compliance,
    wheel_order_disturbance,
    motor_order_ripple,
    running_resistance,
    sensor_gain,
    sensor_offset,
    channel_skew,
    sensor_quantization,
    parameter_mismatch,
)

EFFECTS: dict[str, Effect] = {module.EFFECT.id: module.EFFECT for module in _MODULES}

__all__ = ["EFFECTS", "SENSED", "Effect", "Parameter", "Stage", "finite_number", "shown"]
